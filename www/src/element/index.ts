/** Defines `<sim3-align>`. */
import { Sim3AlignElement } from "./element.js";

export { Sim3AlignElement };

if (customElements.get("sim3-align") === undefined) customElements.define("sim3-align", Sim3AlignElement);
