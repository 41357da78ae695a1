import { useState } from "react";
import { useAlignment } from "./use-alignment.js";

/** Kept, because another object would be another call. */
const options = { quality: "fast" };

function Placement({ input }) {
  const { state, fraction, result, error } = useAlignment(input, options);
  return (
    <p id="status" data-state={state}>
      {state === "running" && <progress value={fraction} />}
      {state === "failed" && `${error.code}: ${error.message}`}
      {state === "done" && <output id="result">{JSON.stringify([...result.matrix])}</output>}
    </p>
  );
}

/** `first` is what the server found; `input` is what the browser aligns again. */
export function App({ first, load }) {
  const [input, setInput] = useState(null);
  const [isShown, setIsShown] = useState(true);
  return (
    <main>
      <p>
        Aligned on the server: <output id="first">{JSON.stringify(first)}</output>
      </p>
      <button type="button" id="align" onClick={async () => setInput(await load())}>
        Align in the browser
      </button>
      <button type="button" id="toggle" onClick={() => setIsShown(!isShown)}>
        {isShown ? "Hide" : "Show"}
      </button>
      {isShown && <Placement input={input} />}
    </main>
  );
}
