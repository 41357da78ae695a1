/** `sim3align/element/shared`: `<sim3-align>` with the three.js of the app, a peer dependency. */
import { takeThreeFrom } from "../view3d/three-source.js";

export { Sim3AlignElement } from "./element.js";

takeThreeFrom(() => import("../view3d/three.js"));
