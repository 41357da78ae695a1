/** Tasks that run side by side. */

/**
 * Runs a task for each item, and yields the results as the tasks finish. An item is taken when its turn comes.
 * @param limit maximum number of tasks at a time
 */
export async function* concurrently<T, R>(
  items: Iterable<T>,
  limit: number,
  run: (item: T) => Promise<R>,
): AsyncGenerator<R, void, undefined> {
  const iterator = items[Symbol.iterator]();
  const running = new Set<Promise<() => R>>();
  for (;;) {
    while (running.size < limit) {
      const next = iterator.next();
      if (next.done) break;
      const task: Promise<() => R> = run(next.value).then((result) => () => {
        running.delete(task);
        return result;
      });
      running.add(task);
    }
    if (running.size === 0) return;
    const finished = await Promise.race(running);
    yield finished();
  }
}
