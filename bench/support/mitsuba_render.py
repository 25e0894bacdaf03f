"""Renders with Mitsuba 3, in a Python environment of its own: the other end of a pipe from bench/peers.py.

The first line of standard input is a scene (peer_scenes.to_mitsuba) as JSON, each further one a request
`{"sampler", "samples", "seed", "image"}`. For each request, the picture is written as .npy, and a line answers,
`{"cpu_s", "wall_s"}`: of rendering alone, with kernels compiled (a first rendering of the same kind is not counted).
"""

import json
import sys
import time

import drjit
import mitsuba
import numpy


def build(description: dict) -> dict:
    """The dictionary with Mitsuba's own transforms in place."""
    transform = mitsuba.ScalarTransform4f
    if isinstance(description, list):
        return [build(value) for value in description]
    if not isinstance(description, dict):
        return description
    result = {key: build(value) for key, value in description.items()}
    if "look_at" in result:
        origin, target, up = result.pop("look_at")
        result["to_world"] = transform().look_at(origin=origin, target=target, up=up)
    if "repeat" in result:
        repeat = result.pop("repeat")
        result["to_uv"] = transform().scale([repeat, -repeat, 1])  # pbrt counts v from the picture's lower edge
    return result


def render(scene: "mitsuba.Scene", request: dict, seed: int) -> tuple[numpy.ndarray, float, float]:
    """One picture, and the seconds that it took: of all threads, and of the clock."""
    sensor = scene.sensors()[0]
    wall, cpu = time.perf_counter(), time.process_time()
    image = mitsuba.render(scene, sensor=sensor, spp=request["samples"], seed=seed)
    drjit.eval(image)
    drjit.sync_thread()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return numpy.array(image), cpu, wall


def main() -> None:
    """Answer requests until standard input ends."""
    mitsuba.set_variant("llvm_ad_rgb")
    description = json.loads(sys.stdin.readline())
    scenes = {}
    for line in sys.stdin:
        request = json.loads(line)
        kind = (request["sampler"], request["samples"])
        if kind not in scenes:
            sampler = {"type": request["sampler"], "sample_count": request["samples"]}
            sensor = {**description["sensor"], "sampler": sampler}
            scenes[kind] = mitsuba.load_dict(build({**description, "sensor": sensor}))
            for seed in (0, 1):
                render(scenes[kind], request, seed)
        image, cpu, wall = render(scenes[kind], request, request["seed"])
        numpy.save(request["image"], image)
        print(json.dumps({"cpu_s": cpu, "wall_s": wall, "version": mitsuba.__version__}), flush=True)


if __name__ == "__main__":
    main()
