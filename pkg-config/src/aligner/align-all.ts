/** Aligns many inputs with bounded memory, and yields each result when it is ready. */

import { beforeAbort, checkSignals, onAnyAbort } from "../concurrency/on-abort.js";
import type { AlignInput } from "../types/inputs.js";
import type { SignalLike } from "../types/platform.js";
import type { AlignAllResult } from "../types/results.js";
import { invalidArgument, type Sim3AlignError } from "../values/error.js";

/** Options of a batch. */
export interface BatchOptions<A> {
  /** Maximum number of inputs pulled but not yet yielded. */
  limit: number;
  ordered: boolean;
  signal: SignalLike | undefined;
  align(input: AlignInput, index: number, signal: SignalLike): Promise<A>;
  /** Whether an error concerns one input only; the others then continue. */
  isOwn(error: unknown): error is Sim3AlignError;
}

type Settled<A> = { result: AlignAllResult<A> } | { failure: unknown };

/** Aligns the inputs. Leaving the loop early cancels the running alignments. */
export async function* alignAll<A extends { input?: AlignInput }>(
  inputs: Inputs,
  { limit, ordered, signal, align, isOwn }: BatchOptions<A>,
): AsyncGenerator<AlignAllResult<A>, void, undefined> {
  const signals = signal === undefined ? [] : [signal];
  checkSignals(signals);
  const stopped = new AbortController();
  const unfollow = onAnyAbort(signals, (reason) => stopped.abort(reason));
  const iterator = iteratorOf(inputs);
  const running = new Map<number, Promise<number>>();
  const settled = new Map<number, Settled<A>>();
  let pull: Promise<"pulled"> | undefined;
  let pulled = 0;
  let hasEnded = false;

  const one = async (input: AlignInput, index: number): Promise<number> => {
    settled.set(index, await outcome(align(input, index, stopped.signal), index, isOwn));
    return index;
  };
  const pullOne = async (): Promise<"pulled"> => {
    const next = await iterator.next();
    if (typeof next !== "object" || next === null) {
      throw invalidArgument("inputs", next, "an iterator whose next() returns { value, done }", "Use a generator.");
    }
    if (next.done === true) hasEnded = true;
    else running.set(pulled, one(next.value, pulled++));
    return "pulled";
  };

  let isWhole = false;
  try {
    for (let next = 0; ; ) {
      if (pull === undefined && !hasEnded && running.size < limit) pull = pullOne();
      if (pull === undefined && running.size === 0) break;
      const awaited = ordered ? [running.get(next)] : running.values();
      checkSignals([stopped.signal]);
      const any = Promise.race([...awaited, pull].filter((promise) => promise !== undefined));
      const first = await beforeAbort(any, [stopped.signal]);
      if (first === "pulled") {
        pull = undefined;
        continue;
      }
      const ready = settled.get(first) as Settled<A>;
      if ("failure" in ready) throw ready.failure;
      yield ready.result;
      settled.delete(first);
      running.delete(first);
      next = first + 1;
    }
    isWhole = true;
  } finally {
    unfollow();
    stopped.abort();
    // The iterator may be busy; its `return()` is not awaited.
    if (!isWhole) Promise.allSettled([pull, iterator.return?.()]);
  }
}

type Inputs = Iterable<AlignInput> | AsyncIterable<AlignInput>;

function iteratorOf(inputs: Inputs): Iterator<AlignInput> | AsyncIterator<AlignInput> {
  // Typed arrays contain no inputs.
  if (typeof inputs === "object" && inputs !== null && !ArrayBuffer.isView(inputs)) {
    const { [Symbol.asyncIterator]: iterateLater, [Symbol.iterator]: iterate } = inputs as Partial<
      Iterable<AlignInput> & AsyncIterable<AlignInput>
    >;
    const method: unknown = iterateLater ?? iterate;
    const iterator = typeof method === "function" ? method.call(inputs) : undefined;
    if (typeof iterator?.next === "function") return iterator;
  }
  const remedy = "Pass an array or a generator of inputs. For a single input, use align().";
  throw invalidArgument("inputs", inputs, "an iterable or an async iterable of inputs", remedy);
}

async function outcome<A extends { input?: AlignInput }>(
  aligned: Promise<A>,
  index: number,
  isOwn: BatchOptions<A>["isOwn"],
): Promise<Settled<A>> {
  try {
    const alignment = await aligned;
    const { input } = alignment;
    delete alignment.input;
    return { result: { index, alignment, ...(input === undefined ? {} : { input }) } };
  } catch (error) {
    if (!isOwn(error)) return { failure: error };
    const { input } = error;
    return { result: { index, error, ...(input === undefined ? {} : { input: input as AlignInput }) } };
  }
}
