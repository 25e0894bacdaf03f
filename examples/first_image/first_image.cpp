// Renders a scene that is a text of the program's own, and shows the image in the terminal.
#include "core/base/error.h"
#include "core/render/render.h"

#include <algorithm>
#include <cstdio>

constexpr const char* kScene = R"(
LookAt 0 1 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 32 "float screenwindow" [ -1.1 1.1 -1 1 ]  # characters are tall
Film "rgb" "integer xresolution" 64 "integer yresolution" 28
WorldBegin
LightSource "distant" "point3 from" [ -3 4 -2 ] "rgb L" [ 5 5 5 ]
Shape "sphere"
)";

int main() try {
    lampyris::RenderRequest request;
    request.scene = lampyris::SceneSource::of_text(kScene, "sphere");
    request.limits.passes = 16;
    const lampyris::RenderOutcome outcome = lampyris::render(request);
    const lampyris::Image image = outcome.image.rgb();
    for (int y = 0; y < image.height; ++y, std::putchar('\n'))
        for (int x = 0; x < image.width; ++x)
            std::putchar(" .:-=+*#%@"[int(9.0f * std::clamp(image.at(x, y, 1), 0.0f, 1.0f))]);
    std::printf("%llu rays, estimated relMSE %.2g\n", static_cast<unsigned long long>(outcome.record.film.rays),
                outcome.record.progress.estimated_error);
} catch (const lampyris::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.code());
}
