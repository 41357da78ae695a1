/** The workspace of the components. */
import { createContext } from "preact";
import { useContext } from "preact/hooks";
import type { Workspace } from "../state/workspace.js";

const Context = createContext<Workspace | null>(null);

/** Gives components a workspace. */
export const WorkspaceProvider = Context.Provider;

/** The workspace of a component. */
export function useWorkspace(): Workspace {
  const workspace = useContext(Context);
  if (workspace === null) throw new Error("This component needs a workspace around it.");
  return workspace;
}
