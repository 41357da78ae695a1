/** Scenes for simulators: bodies, mass and rest, and the files, which the simulators themselves load. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { toSim3 } from "sim3align/conventions";
import { type SimulatorObject, type SimulatorScene, simulatorScene, toMjcf, toUrdf, toUsd } from "sim3align/simulators";
import { folder, read, refusesUsage, run, succeeds, writeCase } from "../support/command-line.js";
import { repository } from "../support/environment.js";
import type { Mesh } from "../support/scene.js";
import { plane, poses, standingMesh, tableFiles, tableView } from "../support/table.js";

const { width, height, camera } = tableView;
const image = { fy: camera.fy, width, height };

/** A box from 0 to these sizes. */
function box(x: number, y: number, z: number): Mesh {
  const positions = Float32Array.from({ length: 24 }, (_, i) => {
    const corner = Math.floor(i / 3);
    return [corner & 1, (corner >> 1) & 1, corner >> 2][i % 3] as number;
  }).map((share, i) => share * ([x, y, z][i % 3] as number));
  const indices = Uint32Array.of(
    ...[0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4],
    ...[2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5],
  );
  return { positions, indices };
}

/** A bowl: a box with a hole from above, of five plates. */
function tray(): Mesh {
  const plates: [number, number, number, number, number, number][] = [
    [0, 0, 0, 0.2, 0.2, 0.02],
    [0, 0, 0.02, 0.02, 0.2, 0.08],
    [0.18, 0, 0.02, 0.02, 0.2, 0.08],
    [0.02, 0, 0.02, 0.16, 0.02, 0.08],
    [0.02, 0.18, 0.02, 0.16, 0.02, 0.08],
  ];
  const positions: number[] = [];
  const indices: number[] = [];
  for (const [x, y, z, ...size] of plates) {
    const plate = box(...size);
    indices.push(...Array.from(plate.indices, (i) => i + positions.length / 3));
    positions.push(...Array.from(plate.positions, (p, i) => p + ([x, y, z][i % 3] as number)));
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

/** The ground of a camera that looks down from 1 m: x right, y towards the top of the image, z up. */
const below = { normal: [0, 0, -1] as const, d: 1 };
/** OpenCV camera from a mesh with z up, at a place over that ground. */
const over = (x: number, y: number, z: number, tiltDeg = 0) => {
  const [s, c] = [Math.sin((tiltDeg * Math.PI) / 180), Math.cos((tiltDeg * Math.PI) / 180)];
  return toSim3([1, 0, 0, 0, 0, -c, -s, 0, 0, s, -c, 0, x, -y, 1 - z, 1]);
};

const near = (a: ArrayLike<number>, b: readonly number[], within: number) =>
  b.forEach((x, i) => {
    assert.ok(Math.abs((a[i] as number) - x) <= within, `${Array.from(a)} and ${b}`);
  });

test("a box has the mass, the centre and the inertia of a box, in its frame", async () => {
  const { bodies, hasGround } = await simulatorScene(
    [{ name: "a box", mesh: box(0.1, 0.2, 0.3), transform: over(0, 0, 0) }],
    {
      support: below,
      density: 500,
    },
  );
  assert.equal(hasGround, true);
  const [body] = bodies;
  assert.ok(body !== undefined);
  assert.equal(body.name, "a_box");
  assert.equal(body.parts.length, 1);
  assert.equal(body.isFixed, false);
  near([body.mass], [3], 1e-6);
  near(body.centerOfMass, [0.05, 0.1, 0.15], 1e-7);
  const moment = (a: number, b: number) => (3 * (a * a + b * b)) / 12;
  near(body.principalMoments, [moment(0.1, 0.2), moment(0.1, 0.3), moment(0.2, 0.3)], 1e-7);
  assert.ok(body.movedM < 1e-6 && body.turnedDeg < 1e-3);
  // The scale of the transform makes metres of units.
  const [large] = (
    await simulatorScene(
      [{ mesh: box(1, 2, 3), transform: { ...over(0, 0, 0), matrix: undefined, scale: 0.1 } as never }],
      { support: below },
    )
  ).bodies;
  near([large?.mass ?? 0], [2.4], 1e-5);
});

test("a body that floats and leans is put at rest; one that leans too much is fixed where it is", async () => {
  const objects: SimulatorObject[] = [
    { name: "leans", mesh: box(0.1, 0.1, 0.2), transform: over(-0.5, 0, 0.004, 3) },
    { name: "falls", mesh: box(0.1, 0.1, 0.2), transform: over(0.5, 0, 0, 30) },
    { name: "hangs", mesh: box(0.1, 0.1, 0.2), transform: over(0, 0.5, 0.4), restsOn: null },
  ];
  const { bodies } = await simulatorScene(objects, { support: below });
  const [leans, falls, hangs] = bodies;
  assert.ok(leans && falls && hangs);
  assert.equal(leans.isFixed, false);
  near([leans.turnedDeg], [3], 1e-3);
  assert.ok(leans.movedM > 1e-3 && leans.movedM < 0.01);
  near([leans.position[2]], [0], 1e-6);
  assert.ok(falls.isFixed && hangs.isFixed);
  assert.equal(falls.movedM + falls.turnedDeg + hangs.movedM, 0);
  assert.ok(
    (await simulatorScene(objects)).bodies.every((body) => body.isFixed),
    "without a support",
  );
});

test("the pose before is kept beside that at rest, in the result and in every file", async () => {
  const objects = [{ name: "leans", mesh: box(0.1, 0.1, 0.2), transform: over(-0.5, 0.1, 0.004, 3) }];
  const scene = await simulatorScene(objects, { support: below });
  const [body] = scene.bodies;
  assert.ok(body);
  near([body.position[2], body.found.position[2]], [0, 0.004], 1e-6);
  assert.notDeepEqual(body.rotation, body.found.rotation);
  const { position, rotation } = body.found;
  const short = (x: number) => String(Number(x.toPrecision(7)));
  const [x, y, z, w] = rotation.map(short);
  const numeric = /<numeric name="leans_found" size="7" data="([^"]*)"/.exec(toMjcf(scene)["scene.xml"] ?? "");
  assert.equal(numeric?.[1], [...position.map(short), w, x, y, z].join(" "));
  const [, inJson] = JSON.parse(toUrdf(scene)["scene.json"] ?? "").bodies;
  assert.deepEqual(inJson.found, { position, quaternion: rotation });
  const usd = toUsd(scene);
  assert.ok(usd.includes(`custom double3 found:translate = (${position.map(short).join(", ")})`));
  assert.ok(usd.includes(`custom quatd found:orient = (${[w, x, y, z].join(", ")})`));
});

test("without rest, no body is moved", async () => {
  const objects = [
    { mesh: box(0.1, 0.1, 0.2), transform: over(-0.5, 0, 0.004, 3) },
    { mesh: box(0.1, 0.1, 0.2), transform: over(-0.404, 0, 0) },
  ];
  const { bodies } = await simulatorScene(objects, { support: { ...below, confidence: 0.9 }, rest: false });
  for (const { found, position, rotation, movedM, turnedDeg, isFixed } of bodies) {
    assert.deepEqual({ position, rotation }, found);
    assert.deepEqual([movedM, turnedDeg, isFixed], [0, 0, false]);
  }
  await assert.rejects(simulatorScene(objects, { rest: "no" as never }), { code: "INVALID_ARGUMENT" });
});

test("a support that was found is moved to what stands on it; one that was given is kept", async () => {
  const camera = { fy: 600, width: 640, height: 480 };
  const objects = [0, 0.3, 0.6].map((x) => ({ mesh: box(0.1, 0.1, 0.1), transform: over(x, 0, -0.005) }));
  const found = await simulatorScene(objects, { support: { ...below, confidence: 0.9 }, camera });
  near([found.supportHeightM, found.camera?.position[2] ?? 0], [0.005, 1.005], 1e-6);
  for (const { movedM, position } of found.bodies) near([movedM, position[2]], [0, 0], 1e-6);
  for (const support of [below, { ...below, confidence: 1 }]) {
    const given = await simulatorScene(objects, { support, camera });
    near([given.supportHeightM, given.camera?.position[2] ?? 0], [0, 1], 1e-6);
    for (const { movedM, position } of given.bodies) near([movedM, position[2]], [0.005, 0], 1e-6);
  }
});

test("a body on another one is put onto it, and stays fixed where it would tip over", async () => {
  const table = { name: "table", mesh: box(0.4, 0.4, 0.1), transform: over(0, 0, 0) };
  const top = (x: number): SimulatorObject => ({
    name: "top",
    mesh: box(0.1, 0.1, 0.1),
    transform: over(x, 0.1, 0.104),
    restsOn: 0,
  });
  const [, stands] = (await simulatorScene([table, top(0.1)], { support: below })).bodies;
  assert.ok(stands && !stands.isFixed);
  near([stands.position[2]], [0.1], 1e-6);
  const [, tips] = (await simulatorScene([table, top(0.37)], { support: below })).bodies;
  assert.ok(tips?.isFixed);
});

test("a tray has several parts, none of which fills it; its hull is one part", async () => {
  const objects = [{ mesh: tray(), transform: over(0, 0, 0) }];
  const [parts] = (await simulatorScene(objects, { support: below })).bodies;
  assert.ok(parts && parts.parts.length >= 5 && parts.parts.length <= 16);
  const volume = 0.2 * 0.2 * 0.02 + 2 * 0.02 * 0.2 * 0.08 + 2 * 0.16 * 0.02 * 0.08;
  assert.ok(Math.abs(parts.mass / 400 / volume - 1) < 0.15, `${parts.mass / 400} and ${volume}`);
  const [hull] = (await simulatorScene(objects, { support: below, maxParts: 1 })).bodies;
  assert.equal(hull?.parts.length, 1);
  near([hull?.mass ?? 0], [400 * 0.2 * 0.2 * 0.1], 1e-5);
});

test("what is not a scene is an error, and flat or degenerate meshes are none", async () => {
  await assert.rejects(simulatorScene("objects" as never), { code: "INVALID_ARGUMENT" });
  await assert.rejects(
    simulatorScene([
      { mesh: { positions: new Float32Array(3), indices: new Uint32Array() }, transform: over(0, 0, 0) },
    ]),
    { code: "EMPTY_MESH" },
  );
  await assert.rejects(simulatorScene([], { density: 0 }), { code: "INVALID_ARGUMENT" });
  await assert.rejects(simulatorScene([], { support: { normal: [0, 0, 0], d: 1 } }), { code: "INVALID_ARGUMENT" });
  const flat = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2) };
  const point = { positions: new Float32Array(9), indices: Uint32Array.of(0, 1, 2) };
  const { bodies } = await simulatorScene(
    [flat, point].map((mesh) => ({ mesh, transform: over(0, 0, 0) })),
    { support: below },
  );
  assert.ok((bodies[0]?.mass ?? 0) > 0);
  assert.equal(bodies[1]?.isFixed, true);
  assert.doesNotMatch(
    Object.values(toMjcf({ bodies, hasGround: true, supportHeightM: 0, camera: null })).join("") +
      toUsd({ bodies, hasGround: true, supportHeightM: 0, camera: null }),
    /NaN|Infinity/,
  );
});

/** What the simulators say after a second of physics. */
interface Simulated {
  mujoco: { bodies: Rested[]; cameras: { position: number[]; axes: number[]; fovYDeg: number }[]; planes: number };
  pybullet: { bodies: Rested[]; ground: boolean };
  usd: {
    bodies: (Omit<Rested, "movedM" | "turnedDeg"> & { centerOfMass: number[] | null; position: number[] })[];
    upAxis: string;
    metresPerUnit: number;
    cameras: number;
    scenes: number;
    complaints: string[];
  };
}

interface Rested {
  name: string;
  fixed: boolean;
  mass: number;
  parts: number;
  movedM: number;
  turnedDeg: number;
}

const python = process.env.SIM3ALIGN_SIMULATORS;
const skip = python === undefined ? "no Python with simulators: `npm run bench:physics` installs it" : false;

function simulated(path: string): Simulated {
  const env = { ...process.env, PYTHONPATH: join(repository, "scripts", "bench"), PYTHONDONTWRITEBYTECODE: "1" };
  const { stdout, stderr } = spawnSync(python as string, ["-m", "simulators", "1", path], { env, encoding: "utf8" });
  assert.match(stdout, /^\{/m, stderr);
  // PyBullet prints its build first.
  return JSON.parse(stdout.split("\n").find((line) => line.startsWith("{")) as string) as Simulated;
}

function write(name: string, scene: SimulatorScene): string {
  const files = { mjcf: toMjcf(scene), urdf: toUrdf(scene), "": { "scene.usda": toUsd(scene) } };
  for (const [part, texts] of Object.entries(files)) {
    for (const [path, text] of Object.entries(texts)) {
      const file = join(folder, name, part, path);
      mkdirSync(dirname(file), { recursive: true });
      writeFileSync(file, text);
    }
  }
  return join(folder, name);
}

test("MuJoCo, PyBullet and USD load a scene; its bodies stay, and have the same mass", { skip }, async () => {
  const objects: SimulatorObject[] = [
    { name: "tray", mesh: tray(), transform: over(0, 0, 0) },
    { name: "in the tray", mesh: box(0.06, 0.06, 0.06), transform: over(0.07, 0.07, 0.021), restsOn: 0 },
    { name: "leans", mesh: box(0.1, 0.1, 0.2), transform: over(-0.5, 0, 0.004, 3) },
    { name: "hangs", mesh: box(0.1, 0.1, 0.2), transform: over(0, 0.5, 0.4), restsOn: null },
  ];
  const scene = await simulatorScene(objects, { support: below, camera: { fy: 600, width: 640, height: 480 } });
  const { mujoco, pybullet, usd } = simulated(write("simple", scene));
  for (const [name, bodies] of Object.entries({ mujoco: mujoco.bodies, pybullet: pybullet.bodies })) {
    assert.deepEqual(
      bodies.map((body) => body.name),
      ["tray", "in_the_tray", "leans", "hangs"],
    );
    for (const [i, body] of bodies.entries()) {
      const own = scene.bodies[i];
      assert.ok(own !== undefined);
      assert.equal(body.fixed, own.isFixed, `${name} ${body.name}`);
      assert.equal(body.parts, own.parts.length);
      if (!own.isFixed) near([body.mass], [own.mass], 1e-5 * own.mass);
      assert.ok(
        body.movedM < 0.005 && body.turnedDeg < 5,
        `${name} ${body.name}: ${body.movedM} m, ${body.turnedDeg}°`,
      );
    }
  }
  assert.ok((scene.bodies[1]?.position[2] ?? 1) < 0.04, "it is not on the hull of the tray");
  assert.equal(mujoco.planes, 1);
  assert.equal(pybullet.ground, true);
  const [view] = mujoco.cameras;
  assert.ok(view !== undefined);
  // The camera is 1 m over the ground, and looks down: its own z is up.
  near([view.position[2] ?? 0], [1], 1e-5);
  near([view.axes[8] ?? 0], [1], 1e-5);
  near([view.fovYDeg], [(2 * Math.atan(240 / 600) * 180) / Math.PI], 1e-4);
  assert.deepEqual(usd.complaints, []);
  assert.deepEqual([usd.upAxis, usd.metresPerUnit, usd.cameras, usd.scenes], ["Z", 1, 1, 1]);
  for (const [i, body] of usd.bodies.entries()) {
    const own = scene.bodies[i];
    assert.ok(own !== undefined);
    assert.deepEqual([body.name, body.fixed, body.parts], [own.name, own.isFixed, own.parts.length]);
    near(body.position, own.position, 1e-5);
    if (body.centerOfMass !== null) near(body.centerOfMass, own.centerOfMass, 1e-5);
  }
});

writeCase("table", tableFiles());

test("the command line writes all formats, and says what is fixed", async (t) => {
  const flags = ["--mjcf", "out/mjcf", "--urdf", "out/urdf", "--usd", "out/scene.usda"];
  mkdirSync(join(folder, "out"));
  const { stdout } = succeeds("scene table --quality fast", ...flags, "--density", "250", "--parts", "4");
  assert.match(stdout, /thing_0: [\d.]+ kg, \d convex parts, free/);
  assert.match(stdout, /thing_2: .*, fixed/);
  const kept = run("scene table --quality fast --mjcf out/kept --no-rest");
  assert.match(kept.stdout, /thing_0: .*, free, where it was found/);
  const xml = read(join("out", "mjcf", "scene.xml"));
  assert.equal(xml.match(/<freejoint\/>/g)?.length, 2);
  assert.match(xml, /type="plane"/);
  assert.match(xml, /<camera name="camera"/);
  await t.test("the simulators load them, and the bodies stay", { skip }, () => {
    const { mujoco, pybullet, usd } = simulated(join(folder, "out"));
    for (const body of [...mujoco.bodies, ...pybullet.bodies])
      assert.ok(body.movedM < 0.005 && body.turnedDeg < 5, JSON.stringify(body));
    assert.deepEqual(usd.complaints, []);
  });
});

test("the command line refuses several scenes, and what it cannot write, before the first", () => {
  refusesUsage({
    "scene table table2 --mjcf many": /--mjcf takes a single scene/,
    "scene table --usd nowhere/scene.usda": /--usd nowhere/,
    "scene table --urdf table/camera.json": /--urdf table\/camera\.json/,
  });
});

test("the masses of a generated object are those of its surface", async () => {
  const [pose] = poses;
  assert.ok(pose !== undefined);
  const { bodies } = await simulatorScene([{ mesh: standingMesh, transform: pose }], {
    support: plane,
    camera: image,
    density: 1000,
  });
  // Its volume by the divergence theorem, independently.
  const { positions: p, indices } = standingMesh;
  let volume = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * (indices[t + k] as number)) as [number, number, number];
    const at = (i: number, k: number) => p[i + k] as number;
    volume +=
      (at(a, 0) * (at(b, 1) * at(c, 2) - at(b, 2) * at(c, 1)) +
        at(a, 1) * (at(b, 2) * at(c, 0) - at(b, 0) * at(c, 2)) +
        at(a, 2) * (at(b, 0) * at(c, 1) - at(b, 1) * at(c, 0))) /
      6;
  }
  const expected = 1000 * Math.abs(volume) * pose.scale ** 3;
  assert.ok(Math.abs((bodies[0]?.mass ?? 0) / expected - 1) < 0.12, `${bodies[0]?.mass} and ${expected}`);
});
