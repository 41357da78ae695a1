/** Runs in each page of the documentation: its search, and buttons that copy code. */
/* global PagefindUI */

const folder = new URL(".", location.href).pathname;
new PagefindUI({ element: "#search", baseUrl: folder, showImages: false, showSubResults: true });
document.querySelector("#search input").ariaLabel = "Search";

for (const block of document.querySelectorAll("main pre")) {
  const frame = document.createElement("div");
  const button = document.createElement("button");
  frame.className = "code";
  button.textContent = "Copy";
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(block.textContent);
      button.textContent = "Copied";
    } catch {
      // The browser may forbid it.
      button.textContent = "Not copied";
    }
    setTimeout(() => {
      button.textContent = "Copy";
    }, 1500);
  });
  block.replaceWith(frame);
  frame.append(block, button);
}
