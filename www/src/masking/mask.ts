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
  const hasRegion = edges.some((mark) => mark.adds);
  useEffect(() => {
    if (!hasRegion) return setRegion(null);
    setBusy(true);
    finder.current?.find(edges);
  }, [JSON.stringify(edges)]);

  const mask = painted(marks, hasRegion ? region : null, before, view);
  const share = mask.reduce((sum, inside) => sum + inside, 0) / mask.length;
  return { mask, share, isBusy };
}
