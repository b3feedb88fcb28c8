"""A moving picture (APNG) of the scene of a report, for documents.

    elbowroom run examples/exchange/cell.toml --out out
    target/playwright/bin/python devtools/moving_picture.py out/report.html docs/pictures/exchange-moving.png --seconds 0 9

Chromium plays the report; its pictures are put into one file as they are.
"""

import argparse
import os
import pathlib
import struct
import zlib

from playwright.sync_api import sync_playwright

SIGNATURE = b"\x89PNG\r\n\x1a\n"
ARGUMENTS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]


def pictures(report, seconds, count, width, height):
    """PNG pictures of the scene of a report at equal times."""
    chromium = os.environ.get("ELBOWROOM_CHROMIUM", "/usr/bin/chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": width + 60, "height": height + 400})
        page.goto(report.resolve().as_uri())
        page.wait_for_selector("#scrub")
        page.wait_for_timeout(2000)
        scene = page.locator("canvas").first
        box = scene.bounding_box()
        bars = page.locator("#status").first.bounding_box() if page.locator("#status").count() else None
        bottom = bars["y"] + bars["height"] if bars else box["y"] + box["height"]
        clip = {"x": box["x"], "y": box["y"], "width": box["width"], "height": bottom - box["y"]}
        first, last = seconds
        for i in range(count):
            time = first + (last - first) * i / (count - 1)
            page.evaluate(
                "t => { const e = document.querySelector('#scrub'); e.value = t;"
                " e.dispatchEvent(new Event('input', {bubbles: true})); }",
                time,
            )
            page.wait_for_timeout(250)
            yield page.screenshot(clip=clip)
        browser.close()


def chunks(png):
    """The chunks of a PNG file: type and data."""
    at = len(SIGNATURE)
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        yield kind, png[at + 8 : at + 8 + length]
        at += 12 + length


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def animation(frames, delay_ms):
    """One APNG of PNG files of the same size and kind."""
    header = next(data for kind, data in chunks(frames[0]) if kind == b"IHDR")
    width, height = struct.unpack(">II", header[:8])
    out, sequence = [SIGNATURE, chunk(b"IHDR", header), chunk(b"acTL", struct.pack(">II", len(frames), 0))], 0
    for i, frame in enumerate(frames):
        parts = list(chunks(frame))
        if dict(parts)[b"IHDR"] != header:
            raise SystemExit(f"picture {i} has another size or kind than the first")
        delay = delay_ms if i + 1 < len(frames) else 1500
        out.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", sequence, width, height, 0, 0, delay, 1000, 0, 0)))
        sequence += 1
        for data in (data for kind, data in parts if kind == b"IDAT"):
            if i == 0:
                out.append(chunk(b"IDAT", data))
            else:
                out.append(chunk(b"fdAT", struct.pack(">I", sequence) + data))
                sequence += 1
    return b"".join([*out, chunk(b"IEND", b"")])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--seconds", nargs=2, type=float, required=True, metavar=("FROM", "TO"))
    parser.add_argument("--pictures", type=int, default=32)
    parser.add_argument("--size", nargs=2, type=int, default=(760, 420), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--delay-ms", type=int, default=200)
    options = parser.parse_args()
    frames = list(pictures(options.report, options.seconds, options.pictures, *options.size))
    options.out.write_bytes(animation(frames, options.delay_ms))
    print(f"{options.out}: {len(frames)} pictures, {options.out.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
