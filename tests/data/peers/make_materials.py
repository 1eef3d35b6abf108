#!/usr/bin/env python3
"""Writes the projects spot, leaves, glass, mirrors, veils and textures beside this script, and renders the same scenes
with Mitsuba 3 as references. One description makes both.

    VENV/bin/python make_materials.py [SCENE ...]      # with the VENV of make_references.py

The pictures are 128 x 96, their channels those of make_references.py.
"""
import math, os, struct, sys, zlib
import numpy as np
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
from make_references import round_mantissa, write_exr

HERE = os.path.dirname(os.path.abspath(__file__))
WIDTH, HEIGHT, RUNS, SPP = 128, 96, 16, 1024
T = mi.ScalarTransform4f
OBJECTS, SHADING = "de.grogra.imp3d.objects.", "de.grogra.imp3d.shading."


def num(v): return repr(float(v))
def nums(vs): return " ".join(num(v) for v in np.asarray(vs, float).reshape(-1))
def translate(x, y, z): m = np.eye(4); m[:3, 3] = (x, y, z); return m
def scale(x, y, z): return np.diag([x, y, z, 1.0])
def turn(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    m = np.eye(4); i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m[i, i] = m[j, j] = c; m[i, j] = -s; m[j, i] = s
    return m
def data(name, value): return '<data gx:name="%s" gx:value="%s"/>' % (name, value)
def rgb(v): return {"type": "rgb", "value": [float(x) for x in v]}
def twosided(bsdf): return {"type": "twosided", "bsdf": bsdf}


class Material:
    """A shader in GroIMP's words, a BSDF in Mitsuba's, and what fills the body."""
    def __init__(self, shader, bsdf, interior=""): self.shader, self.bsdf, self.interior = shader, bsdf, interior


def rgba(color, alpha=1.0, ior=None):
    shader = '<object gx:name="shader" gx:type="%sRGBAShader" gx:value="false %s %s"/>' % (SHADING, nums(color), num(alpha))
    if ior:
        interior = '<object gx:name="interior" gx:type="%sIOR" indexOfRefraction="%s"/>' % (SHADING, num(ior))
        return Material(shader, {"type": "dielectric", "int_ior": float(ior), "ext_ior": 1.0}, interior)
    bsdf = twosided({"type": "diffuse", "reflectance": rgb(color)})
    if alpha < 1: bsdf = {"type": "mask", "opacity": float(alpha), "bsdf": bsdf}
    return Material(shader, bsdf)


def phong(channels, bsdf):
    return Material('<object gx:name="shader" gx:type="%sPhong">%s</object>' % (SHADING, channels), bsdf)


def color_channel(name, color): return '<object gx:name="%s" gx:type="de.grogra.math.RGBColor" gx:value="false %s"/>' % (name, nums(color))
def grey_channel(name, value): return '<object gx:name="%s" gx:type="de.grogra.math.Graytone" value="%s"/>' % (name, num(value))


def mirror(color):
    channels = color_channel("diffuse", (0, 0, 0)) + color_channel("specular", color) + grey_channel("shininess", 1.0)
    return phong(channels, twosided({"type": "conductor", "material": "none", "specular_reflectance": rgb(color)}))


def checker(odd, even):
    """on a parallelogram, whose uv run from 0 to 1 in both worlds"""
    fields = color_channel("color1", odd) + color_channel("color2", even)
    # GroIMP: two by two fields, even parity color2; Mitsuba: color0 where the parity is even
    texture = {"type": "checkerboard", "color0": rgb(even), "color1": rgb(odd), "to_uv": T().scale([1, 1, 1])}
    shader = '<object gx:name="diffuse" gx:type="%sChecker">%s</object>' % (SHADING, fields)
    return phong(shader, twosided({"type": "diffuse", "reflectance": texture}))


class Scene:
    def __init__(self, name, eye, target, fov, depth, integrator="path"):
        self.name, self.eye, self.target, self.fov, self.depth = name, eye, target, fov, depth
        self.nodes, self.images, self.shared, self.next_id = [], {}, [], 1
        self.mitsuba = {"type": "scene", "integrator": {"type": integrator, "max_depth": depth + 1}}

    def node(self, kind, matrix, content, mitsuba=None):
        transform = '<object gx:name="transform" gx:type="de.grogra.math.TMatrix4d" gx:value="%s"/>' % nums(matrix)
        self.nodes.append('<node id="%d" type="%s%s" edges="+">%s%s</node>' % (self.next_id, OBJECTS, kind, transform, content))
        if mitsuba: self.mitsuba["m%d" % self.next_id] = mitsuba
        self.next_id += 1

    def sphere(self, matrix, radius, m):
        self.node("Sphere", matrix, m.shader + m.interior + data("radius", num(radius)),
                  {"type": "sphere", "radius": float(radius), "to_world": T(matrix), "bsdf": m.bsdf})

    def box(self, matrix, width, height, length, m):
        fields = "".join(data(n, num(v)) for n, v in (("width", width), ("height", height), ("length", length)))
        self.node("Box", matrix, m.shader + m.interior + fields,
                  {"type": "cube", "to_world": T(matrix @ translate(0, 0, length / 2) @ scale(width / 2, height / 2, length / 2)), "bsdf": m.bsdf})

    def tube(self, matrix, radius, length, m):
        fields = data("radius", num(radius)) + data("length", num(length)) + data("baseOpen", "true") + data("topOpen", "true")
        self.node("Cylinder", matrix, m.shader + m.interior + fields,
                  {"type": "cylinder", "radius": float(radius), "p0": [0, 0, 0], "p1": [0, 0, float(length)], "to_world": T(matrix), "bsdf": m.bsdf})

    def parallelogram(self, matrix, width, length, m, power=None):
        base = np.eye(4); base[:3, 0] = (width / 2, 0, 0); base[:3, 1] = (0, 0, length / 2); base[:3, 2] = (0, -1, 0); base[:3, 3] = (0, 0, length / 2)
        content = m.shader + data("length", num(length)) + '<object gx:name="axis" gx:value="%s 0.0 0.0"/>' % num(width / 2)
        shape = {"type": "rectangle", "to_world": T(matrix @ base), "bsdf": m.bsdf}
        if power:                                             # shines along local +y, Mitsuba's rectangle along -y
            content += ('<object gx:name="light" gx:type="%sAreaLight">%s%s</object>' % (OBJECTS, data("power", num(sum(power))), data("exponent", "0.0")))
            flip = np.diag([-1.0, 1.0, -1.0, 1.0])
            shape["to_world"] = T(matrix @ base @ flip)
            shape["emitter"] = {"type": "area", "radiance": rgb([p / (math.pi * width * length) for p in power])}
        self.node("Parallelogram", matrix, content, shape)

    def ground(self, m): self.parallelogram(turn("x", -90) @ translate(0, 0, -20), 40, 40, m)

    def light(self, kind, matrix, fields, mitsuba):
        self.node("LightNode", matrix, '<object gx:name="light" gx:type="%s%s">%s</object>' % (OBJECTS, kind, fields), mitsuba)

    def white(self): return '<object gx:name="color" gx:value="false 1.0 1.0 1.0"/>'

    def point(self, position, watts):
        self.light("PointLight", translate(*position), self.white() + data("power", num(watts)),
                   {"type": "point", "position": list(map(float, position)), "intensity": rgb([watts / 3 / (4 * math.pi)] * 3)})

    def sky(self, density, color):
        shader = '<object gx:name="shader" gx:type="%sRGBAShader" gx:value="false %s 1.0"/>' % (SHADING, nums(color))
        self.node("Sky", np.eye(4), shader + data("powerDensity", num(density)),
                  {"type": "constant", "radiance": rgb([density / (12 * math.pi) * c for c in color])})

    def write(self):
        folder = os.path.join(HERE, self.name)
        os.makedirs(os.path.join(folder, "images"), exist_ok=True) if self.images else os.makedirs(folder, exist_ok=True)
        eye, target = np.array(self.eye, float), np.array(self.target, float)
        back = (eye - target) / np.linalg.norm(eye - target)
        right = np.cross((0, 0, 1), back); right /= np.linalg.norm(right)
        view = np.eye(4); view[:3, :3] = (right, np.cross(back, right), back); view[:3, 3] = -view[:3, :3] @ eye
        with open(os.path.join(folder, "graph.xml"), "w") as f:
            f.write('<?xml version="1.0" encoding="UTF-8"?>\n<graph xmlns="http://grogra.de/xmlpersistence" xmlns:gx="http://grogra.de/xmlpersistence">\n'
                    '<node root="MainGraph" id="0" type="de.grogra.graph.impl.Node">\n%s\n</node>\n%s</graph>\n' % ("\n".join(self.nodes), "".join(self.shared)))
        images = "".join('<de.grogra.pf.ui.registry.FileObjectItem mimeType="image/png" name="%s" systemId="pfs:images/%s.png" type="de.grogra.imp.objects.FixedImageAdapter"/>' % (n, n) for n in self.images)
        for n, pixels in self.images.items(): write_png(os.path.join(folder, "images", n + ".png"), pixels)
        with open(os.path.join(folder, "project.gs"), "w") as f:
            f.write('<?xml version="1.0" encoding="UTF-8"?><project xmlns="http://grogra.de/registry" graph="graph.xml">\n<import plugin="de.grogra.imp3d" version="1.5"/>\n<registry>\n'
                    '<ref name="project"><ref name="objects"><ref name="images">%s</ref></ref></ref>\n<ref name="workbench"><ref name="state">\n'
                    '<de.grogra.pf.ui.registry.Layout name="layout"><de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="camera=(minZ=0.1 maxZ=2000.0 '
                    'projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=%s] transformation=(%s))"/></de.grogra.pf.ui.registry.Layout>\n</ref></ref>\n</registry></project>\n'
                    % (images, num(math.radians(self.fov)), nums(view)))

    def render(self):
        self.mitsuba["sensor"] = {"type": "perspective", "fov": float(self.fov), "fov_axis": "x", "near_clip": 1e-3, "far_clip": 1e5,
                                  "to_world": T().look_at(origin=list(map(float, self.eye)), target=list(map(float, self.target)), up=[0, 0, 1]),
                                  "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "pixel_format": "rgb", "component_format": "float32",
                                           "rfilter": {"type": "box"}, "sample_border": False},
                                  "sampler": {"type": "independent"}}
        scene = mi.load_dict(self.mitsuba)
        total = np.zeros((HEIGHT, WIDTH, 3)); square = np.zeros_like(total)
        for run in range(RUNS):
            x = np.array(mi.render(scene, spp=SPP, seed=1000 + run)).astype(np.float64)
            total += x; square += x * x
        mean = total / RUNS
        error = np.sqrt(np.maximum(square / RUNS - mean ** 2, 0) * RUNS / (RUNS - 1) / RUNS)
        write_exr(os.path.join(HERE, self.name + ".exr"), np.concatenate([mean.astype(np.float32), round_mantissa(error, 10)], axis=2),
                  ["R", "G", "B", "stderr.R", "stderr.G", "stderr.B"])
        print("%s: mean %s, median error %.2f %%" % (self.name, " ".join("%.6f" % v for v in mean.mean((0, 1))), 100 * np.median(error / np.maximum(mean, 1e-6))), flush=True)


def write_png(path, pixels):
    h, w, _ = pixels.shape
    def chunk(kind, body): return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    rows = b"".join(b"\0" + pixels[y].tobytes() for y in range(h))
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 6, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def spot():
    s = Scene("spot", (0, -6, 4), (0, 0, 0.4), 40, 5)
    s.ground(rgba((0.6, 0.55, 0.5)))
    s.sphere(translate(-0.9, 0.1, 0.5), 0.5, rgba((0.7, 0.2, 0.15)))
    s.box(translate(0.5, 0.4, 0) @ turn("z", 30), 0.7, 0.6, 0.9, rgba((0.2, 0.35, 0.7)))
    s.tube(translate(1.2, -0.8, 0.3) @ turn("y", 70) @ turn("x", 20), 0.25, 0.9, rgba((0.25, 0.6, 0.2)))
    # an almost sharp cone, since the rims of the two renderers have other profiles
    place = translate(0.8, -1.0, 4.0) @ turn("x", 166) @ turn("y", 8)
    inner, outer, watts = math.radians(25.0), math.radians(25.01), 200.0
    solid = 2 * math.pi * (1 - 0.5 * (math.cos(inner) + math.cos(outer)))
    s.light("SpotLight", place, s.white() + data("power", num(watts)) + data("innerAngle", num(inner)) + data("outerAngle", num(outer)),
            {"type": "spot", "to_world": T(place), "intensity": rgb([watts / 3 / solid] * 3), "cutoff_angle": 25.01, "beam_width": 25.0})
    # Where only rare second bounces arrive, the scatter of few samples says little about their error.
    s.sky(2.0, (0.8, 0.9, 1.0))
    return s


def leaves():
    """cut-out leaves in sun and sky: shadows with holes"""
    s = Scene("leaves", (0, -5, 3), (0, 0, 0.8), 40, 5, "volpath")
    s.ground(rgba((0.5, 0.45, 0.4)))
    n = 64
    y, x = np.mgrid[0:n, 0:n]
    alpha = (((x - 31.5) / 24) ** 2 + ((y - 31.5) / 30) ** 2 < 1) & ~(((x // 8) + (y // 8)) % 5 == 0)
    pixels = np.zeros((n, n, 4), np.uint8); pixels[..., :3] = (40, 110, 30); pixels[(x // 4) % 3 == 0, 0] = 90; pixels[..., 3] = np.where(alpha, 255, 0)
    s.images["leaf"] = pixels
    s.shared.append('<node id="900" type="%sImageMap"><data gx:name="bilinearFiltering" gx:value="false"/><shared gx:name="image" gx:value="/:&quot;/project/objects/images/leaf&quot;"/></node>\n' % SHADING)
    flip = T().translate([0, 1, 0]).scale([1, -1, 1])
    part = lambda a: {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(a.astype(np.float32) / 255)), "raw": True, "filter_type": "nearest", "wrap_mode": "clamp", "to_uv": flip}
    leaf = phong('<ref gx:name="diffuse" gx:value="900"/>', {"type": "mask", "opacity": part(pixels[..., 3:4]), "bsdf": twosided({"type": "diffuse", "reflectance": part(pixels[..., :3])})})
    random = np.random.default_rng(5)
    for k in range(12):
        place = translate(*random.uniform((-1.2, -0.8, 0.2), (1.2, 0.8, 1.5))) @ turn("z", random.uniform(0, 360)) @ turn("x", random.uniform(20, 110))
        s.parallelogram(place, 0.6, 0.8, leaf)
    sun = turn("z", 30) @ turn("x", 145)
    s.light("DirectionalLight", sun, s.white() + data("powerDensity", "9.0"), {"type": "directional", "to_world": T(sun), "irradiance": rgb([3.0] * 3)})
    s.sky(15.0, (0.5, 0.7, 1.0))
    return s


def glass():
    s = Scene("glass", (0, -5, 2.5), (0, 0, 0.6), 38, 10)
    s.ground(rgba((0.5, 0.5, 0.5)))
    s.sphere(translate(-0.8, 0, 0.7), 0.7, rgba((0, 0, 0), 0.0, 1.5))
    s.box(translate(0.9, 0.2, 0.05) @ turn("z", 35), 0.9, 0.7, 1.1, rgba((0, 0, 0), 0.0, 1.33))
    s.sphere(translate(0.1, 1.4, 0.4), 0.4, rgba((0.7, 0.2, 0.1)))
    s.sky(20.0, (0.8, 0.9, 1.0))
    return s


def mirrors():
    s = Scene("mirrors", (0, -5, 2.5), (0, 0, 0.6), 38, 6)
    s.ground(rgba((0.4, 0.5, 0.4)))
    s.sphere(translate(-0.8, 0, 0.7), 0.7, mirror((0.9, 0.8, 0.6)))
    s.box(translate(0.9, 0.3, 0) @ turn("z", 25), 0.8, 0.8, 1.2, mirror((0.7, 0.75, 0.8)))
    s.sphere(translate(0.1, -0.9, 0.3), 0.3, rgba((0.7, 0.2, 0.1)))
    s.point((2.0, -2.0, 3.5), 300.0)
    s.sky(6.0, (0.8, 0.9, 1.0))
    return s


def veils():
    """half-transparent sheets before and behind each other"""
    s = Scene("veils", (0, -5, 2.5), (0, 0, 0.8), 40, 5, "volpath")
    s.ground(rgba((0.6, 0.6, 0.6)))
    for k, (color, alpha) in enumerate([((0.8, 0.2, 0.1), 0.5), ((0.2, 0.7, 0.2), 0.3), ((0.2, 0.3, 0.9), 0.7)]):
        s.parallelogram(translate(-0.8 + 0.6 * k, -0.4 + 0.5 * k, 0.1) @ turn("z", -15 + 20 * k) @ turn("x", -8), 1.3, 1.5, rgba(color, alpha))
    s.sphere(translate(0.2, 1.6, 0.5), 0.5, rgba((0.9, 0.85, 0.3)))
    s.point((-1.5, -2.5, 3.5), 300.0)
    s.sky(4.0, (0.6, 0.8, 1.0))
    return s


def textures():
    s = Scene("textures", (0, -4.5, 3), (0, 0, 0.5), 42, 5)
    s.parallelogram(turn("x", -90) @ translate(0, 0, -2), 4, 4, checker((0.8, 0.75, 0.6), (0.15, 0.2, 0.3)))
    s.parallelogram(translate(-0.6, 0.8, 0) @ turn("z", 20), 1.4, 1.4, checker((0.7, 0.2, 0.1), (0.1, 0.5, 0.2)))
    s.tube(translate(0.8, 0.2, 0), 0.35, 1.2, rgba((0.5, 0.5, 0.6)))
    lamp = translate(0.5, 1.0, 3.0) @ turn("x", 90) @ turn("z", 180)
    # the lamp's colour is that of its shader: white light, and a black surface is not possible in GroIMP
    s.parallelogram(lamp, 1.0, 1.0, rgba((0.01, 0.01, 0.01)), power=(30.0, 30.0, 30.0))
    s.sky(3.0, (0.7, 0.8, 1.0))
    return s


if __name__ == "__main__":
    for make in (spot, leaves, glass, mirrors, veils, textures):
        if len(sys.argv) > 1 and make.__name__ not in sys.argv[1:]: continue
        scene = make(); scene.write(); scene.render()
