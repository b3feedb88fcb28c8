"""A moving picture (APNG) of the scene of a report, for documents.

    elbowroom run examples/exchange/cell.toml --out out
    target/playwright/bin/python devtools/moving_picture.py out/report.html docs/pictures/exchange-moving.png --seconds 0 10 --pictures 19

Chromium plays the report; its pictures are put into one file as they are.
"""

import argparse
import os
import pathlib
import struct
import zlib

from playwright.sync_api import sync_playwright

# A picture of this size has no scene in it.
BLANK_BYTES = 20_000
TRIES = 6
SIGNATURE = b"\x89PNG\r\n\x1a\n"
ARGUMENTS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]


def pictures(report, seconds, count, width, height):
    """PNG pictures of the scene of a report at equal times."""
    chromium = os.environ.get("ELBOWROOM_CHROMIUM", "/usr/bin/chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": width, "height": height + 900})
        page.goto(report.resolve().as_uri())
        page.wait_for_selector("#scrub")
        page.wait_for_timeout(2000)
        style = f"#labels {{ display: none }} .canvas-box {{ height: {height}px !important; aspect-ratio: auto !important }}"
        page.add_style_tag(content=style)
        page.evaluate("() => window.dispatchEvent(new Event('resize'))")
        page.wait_for_timeout(4000)
        scene, readout = (page.locator(which).bounding_box() for which in ("#canvas", "#readout"))
        tall = readout["y"] + readout["height"] - scene["y"]
        clip = {"x": scene["x"], "y": scene["y"], "width": scene["width"], "height": tall}
        first, last = seconds
        for i in range(count):
            time = first + (last - first) * i / (count - 1)
            for _ in range(TRIES):
                page.evaluate(
                    "t => { const e = document.querySelector('#scrub'); e.value = t;"
                    " e.dispatchEvent(new Event('input', {bubbles: true})); }",
                    time,
                )
                page.wait_for_timeout(400)
                picture = page.screenshot(clip=clip)
                # Now and then the scene is not drawn yet.
                if len(picture) > BLANK_BYTES:
                    break
            yield picture
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
    parser.add_argument("--pictures", type=int, default=20)
    parser.add_argument("--size", nargs=2, type=int, default=(760, 400), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--delay-ms", type=int, default=300)
    options = parser.parse_args()
    frames = list(pictures(options.report, options.seconds, options.pictures, *options.size))
    options.out.write_bytes(animation(frames, options.delay_ms))
    print(f"{options.out}: {len(frames)} pictures, {options.out.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
