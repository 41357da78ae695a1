/** Components that are loaded when they are first wanted. */
import { signal } from "@preact/signals";
import type { ComponentType } from "preact";
import { useEffect } from "preact/hooks";

/** A component that renders nothing until `isWanted`, which may use hooks, says so and its script is there. */
export function lazy<P extends object = object>(
  isWanted: () => boolean,
  load: () => Promise<ComponentType<P>>,
): ComponentType<P> {
  const loaded = signal<ComponentType<P> | null>(null);
  return function Lazy(properties: P) {
    const wanted = isWanted();
    useEffect(() => {
      if (!wanted || loaded.peek() !== null) return;
      load().then((component) => {
        loaded.value = component;
      }, console.error);
    }, [wanted]);
    const Loaded = loaded.value;
    return wanted && Loaded !== null ? <Loaded {...properties} /> : null;
  };
}
