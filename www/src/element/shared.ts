/** `sim3align/element/shared`: `<sim3-align>` with the three.js of the app, a peer dependency. */
import { takeThreeFrom } from "../view3d/three-source.js";

export * from "./define.js";

takeThreeFrom(() => import("../view3d/three.js"));
