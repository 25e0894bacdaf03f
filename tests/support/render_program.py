"""Runs `lampyris render` and reads its output files."""

import json
import struct
import subprocess

SCENE = """LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Sampler "independent" "integer pixelsamples" 4
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "string filename" "named.exr"
Integrator "path" "integer maxdepth" 3
WorldBegin
LightSource "infinite" "rgb L" [ 0.5 0.6 0.7 ]
Material "diffuse" "rgb reflectance" [ 0.8 0.5 0.2 ]
Shape "sphere" "float radius" 1
"""


def command(program, *arguments):
    return [str(program), "render", *map(str, arguments)]


def run(program, *arguments, **options):
    options.setdefault("timeout", 60)
    return subprocess.run(command(program, *arguments), capture_output=True, text=True, check=False, **options)


def stats_of(path):
    return json.loads(path.read_text())


def read_pfm(path):
    """Width, height and rows from the top of RGB triples."""
    data = path.read_bytes()
    kind, size, scale, pixels = data.split(b"\n", 3)
    assert kind == b"PF"
    assert float(scale) == -1.0
    width, height = map(int, size.split())
    numbers = struct.unpack(f"<{width * height * 3}f", pixels)
    rows = [numbers[3 * width * y : 3 * width * (y + 1)] for y in range(height)][::-1]
    return width, height, rows


def read_exr_header(path):
    """Attributes of a single-part OpenEXR file: name -> raw value (OpenEXR's file layout, 'Attributes')."""
    data = path.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01"
    at, attributes = 8, {}
    while data[at] != 0:
        name_end = data.index(b"\0", at)
        type_end = data.index(b"\0", name_end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        attributes[data[at:name_end].decode()] = data[type_end + 5 : type_end + 5 + size]
        at = type_end + 5 + size
    return attributes


def exr_channels(attributes):
    names, at, raw = [], 0, attributes["channels"]
    while raw[at] != 0:
        end = raw.index(b"\0", at)
        names.append(raw[at:end].decode())
        at = end + 17
    return names
