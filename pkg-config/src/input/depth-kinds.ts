/** Descriptions of the kinds of depth for documents and user interfaces. */
import type { DepthImage, DepthKind } from "../types/inputs.js";

/** A kind of depth. */
interface KindOfDepth {
  /** Title in the user interface. */
  title: string;
  /** Meaning of the values, as a noun phrase. */
  values: string;
  /** The unknowns that are estimated with the pose. */
  estimated: string;
}

const unitKnown = "in a known unit";
const unitUnknown = "times an unknown factor";
const shifted = `${unitUnknown}, plus an unknown shift`;

/** The kinds of depth, the default first. The readers and the core take all but `ray-distance`, which needs the camera. */
export const depthKinds: { readonly [K in DepthKind]: KindOfDepth } = {
  metric: { title: "Distances", values: `distances along the optical axis ${unitKnown}`, estimated: "nothing" },
  "ray-distance": {
    title: "Distances along the rays",
    values: `distances from the camera's centre, along the ray of each pixel, ${unitKnown}`,
    estimated: "nothing",
  },
  "scale-invariant": {
    title: "Distances, scale unknown",
    values: `distances along the optical axis ${unitUnknown}`,
    estimated: "the scale, if a length is known",
  },
  "affine-invariant": {
    title: "Relative depth, far is large",
    values: `distances along the optical axis ${shifted}`,
    estimated: "shift, and the scale if a length is known",
  },
  "affine-invariant-disparity": {
    title: "Disparity, near is large",
    values: `inverse distances ${shifted}; near is large`,
    estimated: "shift, and the scale if a length is known",
  },
};

/** The unit of metric depth about which nothing else is known. */
export const defaultUnits = "floats are metres, integers (16-bit PNG) millimetres";

/** The unit of a depth map for people: `0.001 m (16-bit integers, assumed)`. */
export function unitText({ metres, source, isAssumed }: DepthImage["unit"]): string {
  const unit = metres === null ? "unknown" : metres === 1 ? "metres" : `${metres} m`;
  return `${unit} (${source}${isAssumed ? ", assumed" : ""})`;
}
