// Adds a range of samples to a pixel. The build appends this file to every radiance function (core/kernel/radiance.h).

BUFFER_RO(0, FilmWindow, window)
BUFFER_RW(2, FilmPixel, film)

KERNEL(pixel_loop) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w);
    uint at = local.y * w.width + local.x;
    FilmPixel pixel = film[at];
    uint i = 0u;
    for (; i < w.samples; ++i) {
        CameraSample camera = camera_sample(w, local, i);
        FirstHit first = no_first_hit();
        PATH_LOG(log_path(LOG_CAMERA_PATH, i, 0u));
        Spectrum radiance = radiance_along(camera.ray, camera.numbers, first);
        PATH_LOG(log_film_sample(i, radiance, camera.weight));
        film_add_first_hit(pixel, first);
        film_add(pixel, film_sensor(radiance), camera.weight, camera.pass);
    }
    if (i != w.samples) REPORT_UNFINISHED();
    pixel.rays += traced_rays[0];
    film[at] = pixel;
}
