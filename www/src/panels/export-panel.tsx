/** Buttons that copy or save results, each with a word what for. */
import { type Export, exportGroups, firstExports } from "../export/export.js";
import { page } from "../state/page.js";
import { Menu } from "../ui/controls.js";

const { announce, scene, selected } = page;

const NO_LINK = "Your own files have no address: save the project instead.";

export function ExportPanel() {
  const [whole, object] = [scene.value, selected.value];
  const isReady = whole !== null && object?.isPlaced === true;
  const button = ({ title, act }: Export) => (
    <button
      key={title}
      type="button"
      disabled={title === "Copy link" && whole?.sample === null}
      onClick={() => {
        if (whole === null || object === null) return;
        act(whole, object).catch((cause) => announce(`${(cause as Error).message}`, "failed"));
      }}
    >
      {title}
    </button>
  );
  return (
    <section class="panel export-panel" style={{ gridArea: "export" }} aria-labelledby="export-title">
      <h2 id="export-title">Export</h2>
      <div class="row">
        <fieldset class="row" disabled={!isReady}>
          <legend class="visually-hidden">Results</legend>
          {firstExports().map(button)}
        </fieldset>
        <Menu title="More formats" label="More formats">
          {exportGroups.map(([group, all]) => (
            <fieldset key={group} class="exports" disabled={!isReady}>
              <legend>{group}</legend>
              {all.map((one) => (
                <>
                  {button(one)}
                  <span class="quiet">{one.title === "Copy link" && whole?.sample === null ? NO_LINK : one.about}</span>
                </>
              ))}
            </fieldset>
          ))}
        </Menu>
      </div>
    </section>
  );
}
