/** The mask of the marks on a photo, with the region that a worker finds for those that follow edges. */
import { useEffect, useRef, useState } from "preact/hooks";
import { Finder } from "./finder.js";
import type { View } from "./grid.js";
import { type Mark, painted } from "./strokes.js";

/** @param before a mask that is there already */
export function useMask(view: View, marks: readonly Mark[], before: Uint8Array | null) {
  const finder = useRef<Finder | null>(null);
  const [region, setRegion] = useState<Uint8Array | null>(null);
  const [isBusy, setBusy] = useState(false);

  useEffect(() => {
    finder.current = new Finder({ ...view }, (found) => {
      setRegion(found);
      setBusy(false);
    });
    return () => finder.current?.stop();
  }, [view]);

  const edges = marks.filter((mark) => mark.followsEdges);
  const adds = edges.some((mark) => mark.adds);
  const hasRegion = adds || (before !== null && edges.length > 0);
  useEffect(() => {
    if (!hasRegion) return setRegion(null);
    setBusy(true);
    // What is only taken away from the mask before is a region, too.
    finder.current?.find(adds ? edges : edges.map((mark) => ({ ...mark, adds: true })));
  }, [JSON.stringify(edges)]);

  const found = hasRegion ? region : null;
  const whole =
    found === null || before === null
      ? (found ?? before)
      : before.map((inside, i) => (adds ? inside | (found[i] as number) : inside & ~(found[i] as number)));
  const mask = painted(marks, whole, view);
  const share = mask.reduce((sum, inside) => sum + inside, 0) / mask.length;
  return { mask, share, isBusy };
}
