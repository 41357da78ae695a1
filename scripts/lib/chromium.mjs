/** A Chromium for the browser tests: found, or installed where that is possible. */
import { installed } from "./system-package.mjs";

/** What to do where there is none. */
export const chromiumRemedy =
  "install Chromium (Debian and Ubuntu: apt-get install chromium), or name one in CHROMIUM_PATH";

/**
 * Finds Chromium; installs it where there is none and this process may (Debian or Ubuntu, as root).
 * @returns {Promise<string | undefined>} its path
 */
export const chromium = () =>
  installed({
    variable: "CHROMIUM_PATH",
    programs: ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"],
    elsewhere: [
      "/Applications/Chromium.app/Contents/MacOS/Chromium",
      "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
      "C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe",
    ],
    debianPackage: "chromium",
  });
