/** Wrong usage of the command line: refused before the first case, with exit status 2 and nothing on stdout. */
import assert from "node:assert/strict";
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { files, folder, read, refusesUsage, runAlone, writeCase } from "../support/command-line.js";
import { frameAt, frameFiles } from "../support/rig.js";
import { tableFiles } from "../support/table.js";

writeCase("blob", files);
writeCase("cases/one", files);
writeCase("views", { "mesh.glb": files["mesh.glb"] });
for (const [k, angle] of [0, 40].entries()) writeCase(`views/frame_0${k}`, frameFiles(frameAt(angle)));
writeCase("table", tableFiles());
for (const name of ["folder", "empty", "other"]) mkdirSync(join(folder, name));
writeFileSync(join(folder, "file"), "");
writeFileSync(join(folder, "photo.jpg"), "");
writeFileSync(join(folder, "file.json"), '{"normal":[1]}');
writeFileSync(join(folder, "other", "index.html"), "mine");
writeFileSync(join(folder, "empty.txt"), "# none\n\n");
const parts = "--depth blob/depth.npy --mask blob/mask.png";

const usage: Record<string, Record<string, RegExp>> = {
  "of commands and folders": {
    align: /at least one case folder/,
    "aling blob": /unknown command/,
    "align cases": /but holds some\. Pass 'cases\/\*\*'/,
    "align table": /table is a scene, not a case: pass it to "sim3align scene"/,
    "check table": /table is a scene, not a case/,
    "track table": /table is a scene, not a video/,
    "scene blob": /blob is a case, not a scene: pass it to "sim3align align"/,
    "scene views": /pass it to "sim3align align", or as a video to "sim3align track"\./,
    "align z*": /z\*: no folder matches the pattern/,
    "align [z-a]*": /\[z-a\]\*: not a pattern/,
    "track empty": /frame_/,
    "align --list nowhere.txt": /--list nowhere\.txt: there is no such file/,
    "align --list empty.txt": /--list: empty\.txt names no case folder/,
    "align --depth blob/depth.npy": /belong together/,
    "align blob --depth blob/depth.npy": /but not both/,
    "align photo.jpg": /is a photo: pass its --depth, --mask and --mesh/,
    [`align photo.jpg ${parts} --mesh blob/mesh.glb --image photo.jpg`]: /one photo/,
    "align blob --image photo.jpg": /--image belongs/,
    [`align ${parts} --mesh nope.glb`]: /--mesh nope\.glb: there is no such file/,
    [`align ${parts} --mesh blob/mesh.glb --camera nope.json`]: /--camera nope\.json: there is no such file/,
    [`align ${parts} --mesh blob/mesh.glb --image nope.png`]: /--image nope\.png: there is no such file/,
    "align --depth= --mask= --mesh=": /--depth "": there is no such file/,
    "scene table --support file.json": /--support file\.json: found \{"normal":\[1\]\}, expected a plane/,
  },
  "of options": {
    "align blob --sead 1": /unknown option '--sead'.*--seed/s,
    "align blob --guard none": /--guard.*option of preset "paper"/,
    "align blob --camera-up 0,-1,0": /--mesh-up: found --camera-up alone, expected --mesh-up as well/,
    "align blob --known-extent 0.1 --scale 1": /--known-extent: .*expected --known-extent or --scale/,
    "align blob --known-extent-axis y": /--known-extent-axis needs --known-extent:/,
    "align blob --depth-near 1": /--depth-near needs --depth-code:/,
    "align blob --depth-far 1": /--depth-far needs --depth-code:/,
    "align blob --mask-index 1": /--mask-index: found number 1, expected nothing beside a mask of its own/,
    [`align ${parts} --mesh blob/mesh.glb --camera 300,300,80,60 --image-id 4`]:
      /--image-id: found .*4.*, expected nothing/,
    "scene table --models folder": /--models needs a scene of BOP/,
    "scene table --mjcf m --parts 0": /--parts.*Expected a whole number, 1 or more/s,
    "scene table --mjcf m --parts 2.5": /--parts.*Expected a whole number, 1 or more/s,
    "scene table --mjcf m --density -1": /--density.*Expected a number above 0/s,
    "align blob --preset fast": /Allowed choices are precise, paper/,
    "align blob --symmetry [{axis}]": /Invalid JSON/,
    "align blob --seed one": /Not a number/,
    "align blob --options [1]": /Expected an object/,
    "align blob --camera 1066,1067,312": /Found 3 values, expected four numbers: fx,fy,cx,cy/,
    "align blob --workers 1.5": /Expected 1 to 64, or "auto"/,
    "align views --preset paper": /several frames/,
  },
  "of outputs": {
    "align blob --json nowhere/out": /--json nowhere.out: the file cannot be written: .*no such/,
    "align blob --csv folder": /--csv folder: this is a folder/,
    "align blob --resume": /--resume needs --jsonl FILE/,
    "align blob --jsonl - --resume": /--resume needs a file/,
    "align blob --jsonl free.jsonl --overlay file": /--overlay file/,
    "align blob --json - --jsonl -": /--json and --jsonl name the same file/,
    "align blob --report file": /--report file: the folder cannot be made/,
    "align blob --report other": /--report other: the folder has other content/,
    "scene table table2 --mjcf many": /--mjcf takes a single scene/,
    "scene table --usd nowhere/scene.usda": /--usd nowhere/,
    "scene table --depth-kind affine-invariant --mjcf m": /--mjcf needs metres.*--known-extent/,
  },
};

for (const [what, messages] of Object.entries(usage))
  test(`wrong usage ${what} is refused`, () => refusesUsage(messages));

test("the exit status is that of the process", () => {
  writeCase("broken", { ...files, "mesh.glb": "glTF" });
  const status = (...args: string[]) => runAlone(...args).status;
  assert.deepEqual([status("--version"), status("align", "broken"), status("aling")], [0, 1, 2]);
});

test("what is refused has written nothing, and leaves no lock", () => {
  assert.equal(read(join("other", "index.html")), "mine");
  for (const path of ["nowhere", "free.jsonl", "free.jsonl.lock", join("other", "rows.js")]) {
    assert.ok(!existsSync(join(folder, path)), path);
  }
});
