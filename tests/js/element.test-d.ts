/** Types of `sim3align/element`, compiled as strictly as users may. Nothing here runs. */
import { type ElementEvents, type GivenScene, Sim3AlignElement, type Sim3AlignProps } from "sim3align/element";

const element: Sim3AlignElement | null = document.querySelector("sim3-align");
const made: Sim3AlignElement = document.createElement("sim3-align");
const scene: GivenScene = { depth: new Blob(), objects: [{ mask: new Uint8Array(1), mesh: new Blob() }] };
made.scene = scene;
made.options = { quality: "fast" };
element?.addEventListener("align", ({ detail }) => detail.objects.map(({ confidence }): number | null => confidence));
// @ts-expect-error There is no such option.
made.options = { speed: "fast" };
// @ts-expect-error A scene has objects.
made.scene = { depth: new Blob() };
export const props: Sim3AlignProps = { scene, onposechange: ({ detail }) => detail.pose.scale.toFixed() };
export const names = (events: ElementEvents): string[] => events.ready.objects;
export const isElement = made instanceof Sim3AlignElement;
