"""Shields around closed meshes of the data, examined by trimesh and Manifold.

usage: shields.py ELBOWROOM DATA [MESHES [TARGETS]]    (needs trimesh, manifold3d, scipy and networkx from PyPI)

Every target is a hole, a line or a circle at a random place of a mesh, scaled to 0.2 m. `elbowroom fixture` makes the shield.
A shield must be closed, consistently oriented, and a manifold with the volume that trimesh finds.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import manifold3d
import numpy as np
import trimesh

SIZE_M = 0.2

CELL = """version = 1
units = {{ length = "m", angle = "deg" }}
[robot.r]
dh = [{{ kind = "prismatic", min = 0, max = 1, speed = 1 }}]
base = {{ at = [0, 0, 5] }}
[robot.r.tool]
tcp = {{ at = [0, 0, 0.1] }}
box = {{ at = [0, 0, 0.05], size = [0.002, 0.002, 0.1] }}
[object.part]
shape = "mesh"
mesh = "part.stl"
[fixture.f]
protects = "part"
target = {target}
width = {width}
offset = {offset}
flare = {flare}
tolerance = 0.003
tool = "r"
{depth}
"""


def closed_meshes(data, count):
    """One closed mesh of 300 to 7,000 triangles per folder, in the order of the names."""
    found = {}
    for file in sorted(p for p in Path(data).rglob("*") if p.suffix.lower() in (".stl", ".obj", ".off")):
        family = file.relative_to(data).parts[1]
        if family in found or "broken" in str(file) or file.stat().st_size > 2_000_000:
            continue
        try:
            mesh = trimesh.load(file, force="mesh")
        except Exception:  # not a mesh for trimesh
            continue
        if not (300 <= len(mesh.faces) <= 7000 and mesh.is_watertight and mesh.volume > 0 and mesh.body_count == 1):
            continue
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
        mesh.apply_scale(SIZE_M / mesh.extents.max())
        found[family] = (file, mesh)
        if len(found) == count:
            break
    return list(found.values())


def target(mesh, random):
    """A hole, a line on one face, or a circle; and what of it `depth` says."""
    face = random.choice(len(mesh.faces), p=mesh.area_faces / mesh.area)
    at, normal = mesh.triangles_center[face], mesh.face_normals[face]
    show = lambda p: "[" + ", ".join(f"{x:.9f}" for x in p) + "]"
    depth = random.uniform(0.0, 0.01)
    kind = random.integers(3)
    if kind == 0:
        return f"{{ drill = {{ at = {show(at)}, axis = {show(-normal)}, depth = {depth:.6f} }} }}", ""
    if kind == 1:
        corners = mesh.triangles[face]
        ends = [at + 0.6 * (corners[k] - at) for k in (0, 1)]
        return f"{{ line = [{show(ends[0])}, {show(ends[1])}] }}", f"depth = {depth:.6f}"
    return f"{{ faces_within = {{ at = {show(at)}, radius = {random.uniform(0.004, 0.015):.6f} }} }}", f"depth = {depth:.6f}"


def examine(shield, answer):
    """What is wrong with a shield."""
    wrong = []
    if not shield.is_watertight:
        wrong.append("open")
    if not shield.is_winding_consistent:
        wrong.append("not oriented")
    body = manifold3d.Manifold(manifold3d.Mesh(np.asarray(shield.vertices, np.float32), np.asarray(shield.faces, np.uint32)))
    if body.status() != manifold3d.Error.NoError:
        wrong.append(f"no manifold: {body.status()}")
    elif abs(body.volume() - shield.volume) > 1e-4 * abs(shield.volume):
        wrong.append(f"volume {body.volume()} and {shield.volume}")
    if not answer["closed"]:
        wrong.append("closed is false")
    return wrong


def main():
    program, data = sys.argv[1], sys.argv[2]
    count, per_mesh = (int(w) for w in (sys.argv[3:5] + ["10", "10"][len(sys.argv[3:5]):]))
    random = np.random.default_rng(7)
    meshes = closed_meshes(data, count)
    made, refused, unreachable, bad, triangles = 0, {}, 0, 0, []
    with tempfile.TemporaryDirectory() as folder:
        for file, mesh in meshes:
            mesh.export(f"{folder}/part.stl")
            for _ in range(per_mesh):
                where, depth = target(mesh, random)
                text = CELL.format(target=where, depth=depth, width=round(random.uniform(0.006, 0.03), 6),
                                   offset=round(random.uniform(0.002, 0.01), 6), flare=round(random.uniform(0, 30), 3))
                Path(f"{folder}/cell.toml").write_text(text)
                run = subprocess.run([program, "fixture", "cell.toml", "--json", "--out", "shield.stl"], cwd=folder,
                                     capture_output=True, text=True)
                if run.returncode == 2:
                    why = run.stderr.strip().splitlines()[0].split("[fixture.f]")[-1][:160]
                    refused[why] = refused.get(why, 0) + 1
                    continue
                made += 1
                answer = json.loads(run.stdout)
                shield = trimesh.load(f"{folder}/shield.stl", force="mesh")
                wrong = examine(shield, answer)
                unreachable += answer["reachable"] is False
                triangles.append(len(shield.faces))
                if wrong:
                    bad += 1
                    print(f"{file.name}: {where}: {', '.join(wrong)}")
            print(f"{file.parent.name}/{file.name}, {len(mesh.faces)} triangles: {made} shields so far", flush=True)
    print(f"{len(meshes)} meshes, {made} shields of {min(triangles)} to {max(triangles)} triangles, {bad} bad, "
          f"{unreachable} with a target that the tool does not reach, {sum(refused.values())} refused")
    for why, times in refused.items():
        print(f"  {times} × {why}")
    sys.exit(bad > 0)


main()
