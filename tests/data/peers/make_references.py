#!/usr/bin/env python3
"""Renders the reference pictures next to this script with Mitsuba 3.

    python -m venv VENV
    VENV/bin/pip install mitsuba==3.9.1 numpy
    VENV/bin/python make_references.py --bench BENCH [cornell penumbra ...]

BENCH is the folder of the benchmark scripts of this project (gen_scenes.py, scenelib.py, harness.py,
peer_mitsuba.py).  The scenes are generated anew in a temporary folder; they are the same as in the
project directories here, which to_groimp.py of the same folder wrote.  The llvm_ad_rgb variant needs
the LLVM library (Debian: libllvm19); without it use --variant scalar_rgb+native+mj, which is slower.

Per scene one SCENE.exr is written:
    R, G, B                         mean radiance of all runs
    stderr.R, stderr.G, stderr.B    standard error of that mean per pixel, from the scatter of the runs

The runs are independent (another seed each) and of equal length, so the error of a pixel's mean is
the sample standard deviation of the runs divided by the square root of their number.
"""
import argparse, json, os, struct, sys, tempfile, time, zlib

# scene: (width, height, samples per pixel and run)
SCENES = {"cornell": (256, 256, 256), "penumbra": (352, 224, 132)}   # 132 = 11 x 12: multijitter rounds up to a grid


def round_mantissa(a, bits):
    """float32 with the mantissa rounded to `bits` bits: an error estimate has no more to say, and it packs better"""
    import numpy as np
    drop = 23 - bits
    i = a.astype(np.float32).view(np.uint32).astype(np.uint64)
    return (((i + (1 << (drop - 1))) >> drop) << drop).astype(np.uint32).view(np.float32)


def write_exr(path, img, names):
    """float32 channels, scan lines, ZIP compression: plain enough for every reader (Mitsuba's own writer only knows PIZ)"""
    import numpy as np
    h, w, _ = img.shape
    order = sorted(range(len(names)), key=lambda i: names[i])           # the format wants the channels sorted
    attr = lambda name, kind, data: name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data
    box = struct.pack("<4i", 0, 0, w - 1, h - 1)
    head = b"\x76\x2f\x31\x01" + struct.pack("<i", 2)
    head += attr("channels", "chlist", b"".join(names[i].encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for i in order) + b"\0")
    head += attr("compression", "compression", b"\3") + attr("dataWindow", "box2i", box) + attr("displayWindow", "box2i", box)
    head += attr("lineOrder", "lineOrder", b"\0") + attr("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attr("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) + attr("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    lines = np.ascontiguousarray(img[:, :, order].transpose(0, 2, 1), dtype="<f4")    # row, channel, x
    blocks = []
    for y in range(0, h, 16):
        raw = np.frombuffer(lines[y:y + 16].tobytes(), np.uint8)
        mixed = np.concatenate([raw[0::2], raw[1::2]])
        delta = mixed.copy()
        delta[1:] = mixed[1:] - mixed[:-1] + np.uint8(128)              # modulo 256
        packed = zlib.compress(delta.tobytes(), 9)
        if len(packed) >= len(raw):
            packed = raw.tobytes()
        blocks.append(struct.pack("<ii", y, len(packed)) + packed)
    at, table = len(head) + 8 * len(blocks), b""
    for b in blocks:
        table += struct.pack("<Q", at)
        at += len(b)
    with open(path, "wb") as f:
        f.write(head + table + b"".join(blocks))


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--bench", required=True, help="folder with scenelib.py, gen_scenes.py and peer_mitsuba.py")
    ap.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)), help="where the EXR files go (default: here)")
    ap.add_argument("--variant", default="llvm_ad_rgb+native+mj", help="default: %(default)s; +native keeps spheres round")
    ap.add_argument("--depth", type=int, default=6, help="path segments at most (default 6; 2 is direct light only)")
    ap.add_argument("--runs", type=int, default=16, help="independent runs (default 16)")
    ap.add_argument("--scale", type=float, default=1.0, help="factor on the samples per pixel of every run")
    ap.add_argument("scenes", nargs="*", help="default: " + " ".join(SCENES))
    a = ap.parse_args()
    sys.path.insert(0, a.bench)
    import numpy as np
    import gen_scenes, peer_mitsuba
    import mitsuba as mi
    from scenelib import Scene

    for name in a.scenes or SCENES:
        width, height, spp = SCENES[name]
        spp = max(1, round(spp * a.scale))
        start = time.time()
        with tempfile.TemporaryDirectory() as tmp:
            gen_scenes.write(name, tmp)
            path = os.path.join(tmp, name, "scene.json")
            with open(path) as f:
                d = json.load(f)
            d["film"].update(width=width, height=height)       # the horizontal field of view stays
            peer = peer_mitsuba.Peer(a.variant)
            peer.build(Scene(d, os.path.dirname(path)), a.depth)
            total = np.zeros((height, width, 3))
            square = np.zeros_like(total)
            for run in range(a.runs):
                x = peer.render(spp, 1000 + run).astype(np.float64)
                total += x
                square += x * x
        mean = total / a.runs
        var = np.maximum(square / a.runs - mean ** 2, 0.0) * a.runs / (a.runs - 1)
        err = np.sqrt(var / a.runs)
        img = np.concatenate([mean.astype(np.float32), round_mantissa(err, 10)], axis=2)
        names = ["R", "G", "B", "stderr.R", "stderr.G", "stderr.B"]
        out = os.path.join(a.out, name + ".exr")
        write_exr(out, img, names)
        back = mi.Bitmap(out)
        found = [field.name for field in back.struct_()]
        assert sorted(found) == sorted(names), found
        assert np.array_equal(np.array(back)[..., [found.index(n) for n in names]], img), "the file does not read back"
        print("%s: %dx%d, %d runs x %d spp = %d spp, depth %d, mean %s, relative error of the mean of pixels %s, "
              "median pixel error %.2f %%, %d bytes, %.0f s, Mitsuba %s %s"
              % (name, width, height, a.runs, peer.actual_spp, a.runs * peer.actual_spp, a.depth,
                 " ".join("%.6f" % v for v in mean.mean((0, 1))),
                 " ".join("%.1e" % v for v in np.sqrt((err ** 2).sum((0, 1))) / (width * height) / mean.mean((0, 1))),
                 100 * np.median(err / np.maximum(mean, 1e-6)),
                 os.path.getsize(out), time.time() - start, mi.__version__, a.variant), flush=True)


if __name__ == "__main__":
    main()
