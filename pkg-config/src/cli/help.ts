/** The help texts of the commands: layouts of folders, frames and units, outputs, and examples. */
import { namesText } from "../case-names.js";
import { defaultUnits, depthKinds } from "../input/depth-kinds.js";
import { csvHeadings } from "./result-files.js";

/** The names of a part, in lines that are indented by two. */
const named = (part: Parameters<typeof namesText>[0]) => namesText(part).replace(/(.{60,105}), /g, "$1,\n  ");

const caseFolder = `
A case folder holds
  ${named("depth")}
                                 z-depth; ${defaultUnits} unless
                                 --depth-scale or the camera file says otherwise; 0 and NaN are "no reading";
                                 --depth-kind for what depth models guess without a unit
  ${named("mask")}
                                 the object: half of the range or more; JSON of COCO, SAM, LabelMe, VIA, Supervisely, ISAT
  ${named("mesh")}
                                 the object in its own frame, in any unit
  ${named("camera")}
                                 optional, JSON or text: {"fx", "fy", "cx", "cy"}, {"K"}, {"fovYDeg"}, ROS CameraInfo,
                                 BOP's scene_camera.json, or the numbers alone, of a matrix or four; without it, the
                                 camera is that of the depth file or of the EXIF data of the photo, or the focal length
                                 is estimated; of a depth and a colour camera, that of the depth is read
  ${named("image")}
                                 optional: the photo, registered to the depth map; compared with the colours of the mesh
  gt.json (optional)             {"scale", "rotation": 3×3 row-major, "translation": m, "symmetry"}: the true pose
or a mesh and folders frame_*, each with a depth map, and optionally a camera and a photo as above, and
  a mask                         in at least one frame; in all of them without pose.json
  pose.json or pose.txt          {"camera_to_world": 4×4 row by row, m}: the camera's pose; in all frames or it is not used
or the folders of FoundationPose: depth/, and optionally rgb/, masks/ and poses/, with a file NAME.* per frame; mesh/ with one
mesh; and a camera such as cam_K.txt. "align" then takes the frames that have a mask.
A camera beside the frames is that of the frames without one. Frames are in the order of their numbers. Upper and lower case
are the same. Files that are not read are named at the end.`;

const conventions = `
Frames and units
  x_cam = s·R·p_mesh + t. The camera looks along +z, x is right, y is down (OpenCV); metres. Pixel centres are at
  whole numbers. "matrix" is column-major (three.js, glTF), "rotation" a quaternion x, y, z, w, "rotationMatrix" its rows.`;

const kinds = `
Depth of models
  --depth-kind says what the values are:
${Object.entries(depthKinds)
  .map(([kind, { values }]) => `    ${kind.padEnd(27)} ${values}`)
  .join("\n")}
  Factor and shift are estimated with the pose. Lengths are then metric only if one is known: --known-extent, or a number
  as --scale. Otherwise they are in units of their own, also in JSON and in GLB files, and "depthCalibration" of the JSON
  entry has { "isMetric": false }; columns in metres are empty, and errors against gt.json are not measured.`;

const transformFile = `
A transform file holds
  - { "scale", "rotation", "translation" }, the rotation as 3×3 numbers, row-major, or as a quaternion x, y, z, w; or
  - the rows of a 4×4 matrix in metres, as text or in JSON; { "matrix" } also as 16 numbers column by column; or
  - an entry of BOP's scene_gt.json; or
  - the output of "sim3align align --json", or a record of --jsonl, from which the entry of the case is read.`;

const status = `
Exit status: 0 everything asked for is there, 1 some case failed or some file cannot be written (the others are done), 2 the
command line is wrong, 130 interrupted by Ctrl-C.`;

/** Lists, workers and outputs, for folders of a kind. */
const batches = (noun: string, mark: string) => `
Batches
  The ${noun}s are worked on side by side; the results do not depend on --workers. Each is read when its turn comes: memory
  grows with the number of workers, not with that of the ${noun}s. A pattern in quotes is expanded by this program:
  * and ? within a name, [abc], {a,b}, and ** for folders at any depth, of which those with ${mark} are taken. Paths in a
  list are relative to the current folder, and stand for themselves; empty lines and lines that begin with # are skipped.
  A terminal shows a bar with rate, time left and failures; elsewhere, a batch of 20 or more prints a line per tenth.
  Rows and entries are in the order in which ${noun}s are done; with --workers 1, in that of the command line. Files appear
  whole, or not at all: --json and --csv when the batch ends, also by Ctrl-C, with what is done. No output may be an input or
  another output.
  --jsonl writes the entries of --json, a line each: { "case", "path", "content", … }, after a line with the version, the
  command and the options. It is the record of a batch: after an interruption, of whatever kind, the same command with
  --resume does what is missing; other options are refused. A ${noun} is known by its path relative to the record, from
  wherever; one that has moved, by the checksum of its files. FILE.lock keeps other programs from writing the record. A line
  that was cut off is removed. A ${noun} whose files have changed since is done again, also if it had failed; one that
  failed with the same files counts as done: remove its lines to try again. --json and --csv are then
  written anew from the record.`;

/** The columns of CSV files, in lines that fit the help. */
const columns = csvHeadings.join(", ").replace(/(.{80,100}), /g, "$1,\n  ");

export const programHelp = `
Examples
  sim3align align cases/mug                      align one case and show everything about it
  sim3align check 'cases/**'                     read all cases, and name what would fail or be doubted
  sim3align align cases/* --json results.json    align several cases; print a table and write a JSON file
  sim3align scene scenes/desk --scene-glb desk.glb     align all objects of a scene; write it as one file
  sim3align track videos/mug                     track an object through the frames of a video
  sim3align evaluate cases/mug --transform results.json
  sim3align serve < requests.jsonl                 align what lines of JSON name; the process stays, for Python, ROS and agents
  sim3align bop bop/lmo --split test               align the targets of a BOP dataset

See "sim3align align --help" for the layout of a case folder, and for the frames and units of the results.
${status}`;

export const alignHelp = `${caseFolder}
${conventions}
${kinds}
${transformFile}

Output
  A table with a row per case: confidence, number of alternatives, scale, its ratio to the initial one, silhouette
  IoU, boundary F, centre drift, Chamfer distance, fitness, depth error and time; with gt.json also the errors against
  it. A single case is shown in detail. The confidence is the probability that the pose is right, 0 to 1. An alternative
  is another pose that explains the observation nearly as well.
  --json writes { "<case>": the result of align() of the API }, with errors against gt.json; inputs, what each file was read
  as: { "depth.png": { as: "depth", unit }, "mask.png": { as: "mask", reading }, … }; and unread, the names of the others. A
  case that failed has { error: { code, argument, found, expected, remedy, message } }. A case with frames has the result of
  alignViews(): its own pose is world from mesh, if the camera poses are known; each of views, with the name of its frame,
  has the pose camera from mesh.
  --csv writes the columns ${columns}.
  --report writes a folder with index.html, which a browser opens from disk: a table to sort and filter, and for each case
  its picture with mask, mesh and depth difference, its alternatives, and a view in 3D. Cases with frames have a row per frame.
  --overlay writes <case>.png, the whole image with the mask and the mesh; --glb writes <case>.glb, the posed mesh in the
  frame of a glTF camera at the origin. Other characters than a-z, 0-9, ".", "_" and "-" change the name of the file.
${batches("case", "a mesh")}

Examples
  sim3align align 'cases/**' --jsonl results.jsonl --csv results.csv --resume
  find cases -name mesh.glb -printf '%h\\n' | sim3align align --list - --workers 4 --jsonl -
  sim3align align 'cases/**' --jsonl results.jsonl --report report --resume
  sim3align align views/mug --json views.json
  sim3align align cases/mug --known-extent 0.095 --known-extent-axis y
  sim3align align cases/mug --initial annotated.json --search local
  sim3align align cases/mug --camera-up 0,-1,0 --mesh-up 0,1,0 --quality best
  sim3align align cases/mug --preset paper --seed 7 --guard 0.8,1.2 --guard-mode clamp
  sim3align align cases/mug --preset paper --options '{"fpfhRadiusVoxels": 4}' --json - | jq .mug.scale
  sim3align align --depth d.png --mask m.png --mesh mug.glb --camera 600,600,320,240 --depth-scale 0.001
  sim3align align photo.jpg --depth moge.npz --mask m.png --mesh mug.glb
  sim3align align photo.jpg --depth d.npy --mask m.png --mesh mug.glb --depth-kind affine-invariant-disparity
${status}`;

export const trackHelp = `${caseFolder}
A video needs a mask in its first frame only. Camera poses are not used.
${conventions}
${kinds}

Output
  A row per frame: state, confidence, scale and its standard deviation, and time.
  --json writes { "<video>": { frames: { "<frame>": the result of next() of the API } } }, with inputs and unread; a frame
  that failed has { error }. A single video is written after each frame, several when each ends. --csv has a row per frame, VIDEO/FRAME.
${batches("video", "a mesh")}

Examples
  sim3align track videos/mug --json poses.json
  sim3align track 'videos/**' --jsonl videos.jsonl --resume --workers 4
  sim3align track videos/mug --known-extent 0.095 --known-extent-axis y
${status}`;

export const checkHelp = `${caseFolder}

Output
  A line per case, or per frame with a mask: that "align" takes it ("track" needs a mask in the first frame only), its error,
  or a line for each doubt about depth, mask, camera and mesh file that reading alone can tell.
  --json writes { "<case>": { warnings, inputs, unread } or { error } }.

Examples
  sim3align check cases/mug
  sim3align check 'cases/**' --json checked.json
  sim3align check --list cases.txt --depth-scale 0.0002
${status}`;

export const serveHelp = `
Requests
  A line of JSON each: { "id": …, "case": "cases/mug" }, or { "id": …, "depth", "mask", "mesh", "camera", "image" } with paths, or
  with arrays as { "base64", "dtype": "float32" | "float64" | "uint16" | "uint8" | "bool" | "uint32", "shape": [height, width] },
  or with the bytes of a file as { "base64" }; a mesh in memory is { "positions", "indices" } of these, a camera in memory
  { "fx", "fy", "cx", "cy" }. "pointMap", an array of height × width × 3, replaces "depth". Further fields: "depthScale",
  "depthKind", "depthCode", "depthNear", "depthFar", "imageId", "resizeMask", "maskIndex", and "options" of align(). Paths are
  relative to the current folder.

Output
  { "id": …, "result": the result of align() of the API } or { "id": …, "error": { code, message, … } }, in the order in which they
  are done; without an id, it is the number of the line, from 0. As many requests as there are workers are worked on at a time.

Examples
  echo '{"case": "cases/mug"}' | sim3align serve
  sim3align serve --workers 4 < requests.jsonl > results.jsonl
  cat requests.jsonl | sim3align serve | jq .result.confidence
${status}`;

export const evaluateHelp = `${caseFolder}
${conventions}

Depth of models
  Metrics need a camera and depth without an unknown shift: --depth-kind is metric, or scale-invariant (times an unknown
  factor). Transforms of scale-invariant depth are in its unit, and lengths are printed as "units"; columns in metres are
  empty.
${transformFile}

Output
  A row per case, or per frame of a case with frames that have a mask; a single case in detail. --json writes
  { "<case>": the result of evaluate() of the API }, or { frames: { "<frame>": the same } }, with inputs and unread.
${batches("case", "a mesh")}

Examples
  sim3align evaluate cases/mug --transform results.json
  sim3align evaluate 'cases/**' --transform results.jsonl --csv scores.csv
  sim3align evaluate views/mug --transform views.json
${status}`;

export const sceneHelp = `
A scene folder holds
  depth.npy or .png …                   as a case folder, see "sim3align align --help"; also the camera and the photo
  objects/NAME/mask.png, …              the mask of each object
  objects/NAME/mesh.glb, …              its mesh; textures are kept by --scene-glb
  objects/NAME/initial.json (optional)  a pose to start from, as gt.json: one candidate among those of the search
  objects/NAME/gt.json (optional)       its true pose
A scene in the layout of BOP (depth/, mask_visib/, scene_camera.json, scene_gt.json, and models in models/, ../models or
../../models) is one as well; --image-id selects the image.
With --sam3d, a folder is an output of SAM 3D Objects: pointmap.npy or depth.*, the photo, and for each object a mask, a GLB or
the PLY of its Gaussians, and pose.json { "rotation", "translation", "scale" }, in objects/NAME/ or with NAME in their names.
Frames are converted; its own placement is one candidate. Its point maps have no unit: pass --depth-kind metric if one has.
${conventions}
  The support is the plane n·x + d = 0 in the camera frame, metres; n points to the side of the objects.
${kinds}
  Files for simulators need metres.

Output
  A row per object: confidence, scale, what it rests on, gap, shared volume, silhouette IoU; with gt.json also the errors
  against it. With --proportions, its lengths in the proportions found are below.
  --json writes { "<scene>": the result of alignScene() of the API }, with errors of the objects, inputs and unread; a scene
  or an object that failed has { error }.
  --csv has a row per object, SCENE/OBJECT. --report, --overlay and --glb write pictures and posed meshes of each object, see "sim3align align --help".
  --scene-glb writes the scene of a single folder: nodes by name, materials and textures, the camera, and the support as
  ground, y up, in metres.
  --mjcf, --urdf and --usd write it for simulators, z up: bodies with mass and convex parts, the support as ground, the camera.
  What rests on the support or on another object is put at rest; what leans, hangs or stands on anything else is fixed.
  --no-rest keeps every pose as it was found; the files hold both.
${batches("scene", "objects")}

Examples
  sim3align scene 'scenes/**' --jsonl scenes.jsonl --csv scenes.csv --resume
  sim3align scene scenes/desk --scale 0.05,0.5
  sim3align scene scenes/desk --snap --scene-glb desk.glb
  sim3align scene scenes/desk --mjcf desk-mujoco --usd desk.usda
  sim3align scene --sam3d outputs/desk --scene-glb desk.glb
  sim3align scene scenes/desk --depth-kind affine-invariant-disparity
  sim3align scene bop/test/000048 --image-id 1 --json -
${status}`;

export const bopHelp = `
A dataset is a folder as BOP publishes it
  models/obj_000001.ply, …       the models, in millimetres, with models_info.json
  SPLIT/SCENE/                   depth/, rgb/ (optional), scene_camera.json and, where they are public, scene_gt.json,
                                 scene_gt_info.json and mask_visib/
  test_targets_bop19.json        what is to be found in a test split; elsewhere, all objects that are a tenth visible
${conventions}

Masks
  --masks gt takes those of the dataset: mask_visib of the most visible instances. A file has 2D detections in BOP's format,
  such as those of CNOS: a list of { scene_id, image_id, category_id, score, segmentation, time }, the masks in COCO RLE. Of
  each object, as many of the best detections are aligned as there are instances; the time of the detections is added.

Output
  The results file METHOD_DATASET-SPLIT.csv, or METHOD_DATASET-SPLIT_SUFFIX.csv with --suffix SUFFIX, in the current folder: scene_id,
  im_id, obj_id, score, R, t in millimetres, and the time, which is the sum over the objects of the image. The score is the
  confidence, multiplied by that of the detection. --jsonl, --resume, --json, --workers, --report, --overlay and --glb work
  as those of "align": cases are called SCENE/IMAGE/OBJECT-INSTANCE.
  bop_toolkit, the official one, scores the file.

Examples
  sim3align bop bop/ycbv --split test --jsonl ycbv.jsonl --resume
  sim3align bop bop/lmo --split test --masks cnos_lmo-test.json --suffix cnos
  sim3align bop bop/tless --split test_primesense --models bop/tless/models_cad
${status}`;
