/** What an element says about its objects, as plain data. */
import type { Sim3 } from "sim3align";
import type { ObjectModel } from "../state/object-model.js";
import { type ObjectWork, stateOf } from "../state/object-work.js";
import { isMetric } from "../state/scene.js";
import type { Workspace } from "../state/workspace.js";
import type { ElementSession as HostSession, ObjectResult } from "./sim3-align.js";

/** As hosts see it, with the state that is opaque to them. */
export interface ElementSession extends HostSession {
  objects: { name: string; state: ObjectWork }[];
}

/** A copy of the pose, which the host may keep and change. */
export const poseOf = ({ pose }: ObjectModel): Sim3 => structuredClone(pose.peek().transform);

export function resultOf({ scene }: Workspace, object: ObjectModel): ObjectResult {
  const whole = scene.peek();
  const { source } = object.pose.peek();
  const isPosed = source !== "start";
  return {
    name: object.name,
    pose: isPosed ? poseOf(object) : null,
    source,
    sizeM: isPosed ? [...object.box.peek().sizeM] : null,
    isMetric: whole === null || isMetric(whole),
    confidence: object.confidence,
    isAccepted: object.isAccepted.peek(),
    metrics: object.metrics.peek(),
  };
}

export function sessionOf({ options, scene }: Workspace): ElementSession {
  const objects = (scene.peek()?.objects ?? []).map((object) => ({ name: object.name, state: stateOf(object) }));
  const calibration = scene.peek()?.calibration ?? null;
  // Plain data only, as after a transfer as JSON.
  return JSON.parse(JSON.stringify({ version: 1, options: options.peek(), calibration, objects })) as ElementSession;
}
