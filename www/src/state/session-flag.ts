/** Whether the browser has kept a session: known at once, before its database is opened. */

const KEY = "sim3align-session";

/** Reads the flag or, with an argument, sets it. */
export function hasSession(value?: boolean): boolean {
  try {
    if (value === true) localStorage.setItem(KEY, "1");
    else if (value === false) localStorage.removeItem(KEY);
    return localStorage.getItem(KEY) === "1";
  } catch {
    // Storage may be blocked.
    return false;
  }
}
