/** The scenes of other tabs: taken over, or opened as copies. */
import { newId } from "../state/inputs.js";
import { page } from "../state/page.js";
import { add, adopt, openLast } from "./index.js";
import { takeOver } from "./owner.js";
import { storedFiles, storedWork, type Work } from "./store.js";

const { othersScenes } = page;

/** Makes the scenes of other tabs scenes of this one: they close there. */
export const takeOverOthers = () =>
  each(async (id) => {
    await takeOver(id);
    const work = await storedWork(id);
    if (work !== null) await adopt(work);
    return work;
  });

/** Opens copies of the scenes of other tabs. What is done from then on is kept apart. */
export const copyOthers = () =>
  each(async (id) => {
    const work = await storedWork(id);
    if (work === null) return null;
    const session = { ...work.session, name: `${work.session.name} (copy)` };
    return add(session, await storedFiles(id), { ...work, id: newId() });
  });

async function each(open: (id: string) => Promise<Work | null>): Promise<void> {
  const opened: Work[] = [];
  for (const { id } of othersScenes.peek()) {
    const work = await open(id);
    // Without one, the other tab has forgotten it.
    if (work !== null) opened.push(work);
  }
  othersScenes.value = [];
  await openLast(opened);
}
