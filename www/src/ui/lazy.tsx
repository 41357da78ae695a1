/** Components that are loaded when they are first wanted. */
import { signal } from "@preact/signals";
import type { ComponentType } from "preact";
import { useEffect } from "preact/hooks";

/** A component that renders nothing until `isWanted` says so and its script is there. */
export function lazy(isWanted: () => boolean, load: () => Promise<ComponentType>): ComponentType {
  const loaded = signal<ComponentType | null>(null);
  return function Lazy() {
    const wanted = isWanted();
    useEffect(() => {
      if (!wanted || loaded.peek() !== null) return;
      load().then((component) => {
        loaded.value = component;
      }, console.error);
    }, [wanted]);
    const Loaded = loaded.value;
    return wanted && Loaded !== null ? <Loaded /> : null;
  };
}
