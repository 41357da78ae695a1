/** The code that repeats the scene that is shown: JavaScript, and the command line. */

import { withoutIds } from "../input/reading.js";
import { sampleUrl } from "../opening/samples.js";
import type { CameraSource, Inputs, NamedFile, ObjectFiles } from "../state/inputs.js";
import { defaultOptions } from "../state/options.js";
import { page } from "../state/page.js";

/** The options that differ from their defaults, as the package has them. */
function options(): Record<string, unknown> {
  const { preset, quality, scaleMin, scaleMax, up, symmetry, seed } = page.options.peek();
  const isOther = { quality: quality !== defaultOptions.quality, seed: seed !== defaultOptions.seed };
  if (preset === "paper") return { preset, ...(isOther.seed && { seed }) };
  return {
    ...(isOther.quality && { quality }),
    ...((scaleMin ?? scaleMax) !== null && { scale: [scaleMin ?? 1e-9, scaleMax ?? 1e9] }),
    ...(up !== "unknown" && { cameraUp: [0, -1, 0], meshUp: up === "y" ? [0, 1, 0] : [0, 0, 1] }),
    ...(symmetry !== defaultOptions.symmetry && { symmetry }),
    ...(isOther.seed && { seed }),
  };
}

/** What is known of one object. */
function known(index: number): Record<string, unknown> {
  const scale = page.objects.peek()[index]?.knownScale.peek() ?? null;
  return scale === null ? {} : { scale };
}

function cameraOf(camera: CameraSource | null): { numbers: string; option: string } | null {
  if (camera === null || camera.kind === "file") return null;
  if (camera.kind === "assumed") return { numbers: `{ fovYDeg: ${camera.fovYDeg} }`, option: `fov:${camera.fovYDeg}` };
  const { fx, fy, cx, cy } = camera;
  return { numbers: `{ fx: ${fx}, fy: ${fy}, cx: ${cx}, cy: ${cy} }`, option: [fx, fy, cx, cy].join() };
}

const cameraFile = ({ camera }: Inputs) => (camera?.kind === "file" ? camera.file : null);

/** The image, if the camera file tells images apart. */
function imageIdIn(inputs: Inputs): string | null {
  const file = cameraFile(inputs);
  return file === null || withoutIds.has(file) ? null : inputs.imageId;
}

/** The files of a scene. */
const filesOf = (inputs: Inputs): NamedFile[] =>
  [
    ...[inputs.depth, cameraFile(inputs), inputs.photo],
    ...inputs.objects.flatMap(({ mask, mesh }) => [mask?.file, mesh?.file]),
  ].flatMap((file) => file ?? []);

/** A program for Node or, with a sample, for browsers as well. */
export function javascript(): string {
  const inputs = page.inputs.peek();
  const { depth, depthKind, depthScale, objects, photo, resizeMasks, sample } = inputs;
  const imageId = imageIdIn(inputs);
  const read = (file: NamedFile | null | undefined) => `await read(${JSON.stringify(file?.path ?? "")})`;
  const camera = cameraOf(inputs.camera);
  const view = [
    `depth: ${read(depth)},`,
    depthScale === null ? "" : `depthScale: ${depthScale},`,
    depthKind === null || depthKind === "metric" ? "" : `depthKind: "${depthKind}",`,
    camera === null ? "" : `camera: ${camera.numbers},`,
    cameraFile(inputs) === null ? "" : `cameraFile: ${read(cameraFile(inputs))},`,
    imageId === null ? "" : `imageId: "${imageId}",`,
    photo === null ? "" : `image: ${read(photo)},`,
    resizeMasks ? 'resizeMask: "nearest",' : "",
  ];
  const parts = ({ mask, mesh }: ObjectFiles, i: number) => [
    `mask: ${read(mask?.file)},`,
    `mesh: ${read(mesh?.file)},`,
    ...Object.entries(known(i)).map(([name, value]) => `${name}: ${JSON.stringify(value)},`),
  ];
  const chosen = options();
  const more = Object.keys(chosen).length === 0 ? "" : `, ${JSON.stringify(chosen)}`;
  const reader =
    sample === null
      ? ['import { readFile as read } from "node:fs/promises";', 'import { createAligner } from "sim3align";']
      : [
          'import { createAligner } from "sim3align";',
          "",
          `const read = async (path) => new Uint8Array(await (await fetch(\`${sampleUrl("")}\${path}\`)).arrayBuffer());`,
        ];
  const lines = (all: readonly string[], indent: string) => all.flatMap((one) => (one === "" ? [] : indent + one));
  const [only] = objects;
  const call =
    objects.length === 1 && only !== undefined
      ? [
          "const result = await aligner.align({",
          ...lines([...view, ...parts(only, 0).slice(0, 2)], "  "),
          `}${Object.keys(known(0)).length === 0 ? more : `, ${JSON.stringify({ ...chosen, ...known(0) })}`});`,
          "console.log(result.scale, result.confidence, result.matrix);",
        ]
      : [
          "const { objects } = await aligner.alignScene({",
          ...lines(view, "  "),
          "  objects: [",
          ...objects.flatMap((one, i) => [
            "    {",
            ...lines([`name: ${JSON.stringify(one.name)},`, ...parts(one, i)], "      "),
            "    },",
          ]),
          "  ],",
          `}${more});`,
          "for (const { name, scale, confidence } of objects) console.log(name, scale, confidence);",
        ];
  return [...reader, "", "const aligner = await createAligner();", ...call, "aligner.dispose();", ""].join("\n");
}

/** A word of a command line. */
const quoted = (text: string) => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/** One command where the files lie as `scene` reads them, otherwise one for each object. Samples are downloaded first. */
export function commands(): string {
  const inputs = page.inputs.peek();
  const { depth, depthKind, depthScale, objects, photo, resizeMasks, sample } = inputs;
  const paths = filesOf(inputs).map(({ path }) => path);
  const download = `curl --create-dirs -o '#1' '${sampleUrl("")}{${paths.join()}}'`;
  const camera = cameraOf(inputs.camera)?.option ?? cameraFile(inputs)?.path;
  const option = (name: string, value: unknown) =>
    value === null || value === undefined || value === false
      ? []
      : [`--${name}${value === true ? "" : ` ${quoted(Array.isArray(value) ? value.join() : `${value}`)}`}`];
  const chosen = (more: Record<string, unknown>) =>
    Object.entries({ ...options(), ...more }).flatMap(([name, value]) =>
      option(
        name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`),
        value,
      ),
    );
  const reading = [
    ...option("depth-scale", depthScale),
    ...option("depth-kind", depthKind === "metric" ? null : depthKind),
    ...option("image-id", imageIdIn(inputs)),
    ...option("resize-mask", resizeMasks ? "nearest" : null),
  ];
  const folder = depth?.path.slice(0, depth.path.lastIndexOf("/")) ?? "";
  const isFolder =
    objects.length > 1 &&
    folder !== "" &&
    objects.every(({ mask }, i) => mask?.file.path.startsWith(`${folder}/objects/`) && !("scale" in known(i)));
  const calls = isFolder
    ? [["npx sim3align scene", quoted(folder), ...reading, ...chosen({})]]
    : objects.map(({ mask, mesh }, i) => [
        "npx sim3align align",
        ...option("depth", depth?.path),
        ...option("mask", mask?.file.path),
        ...option("mesh", mesh?.file.path),
        ...option("camera", camera),
        ...option("image", photo?.path),
        ...[...reading, ...chosen(known(i))],
      ]);
  return [...(sample === null ? [] : [download]), ...calls.map((words) => words.join(" ")), ""].join("\n");
}
