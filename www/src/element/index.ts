/** `sim3align/element`: `<sim3-align>` with a copy of three.js. */
import { takeThreeFrom } from "../view3d/three-source.js";

export { Sim3AlignElement } from "./element.js";

takeThreeFrom(() => import("../view3d/three.js"));
