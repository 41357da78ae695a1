/** Shows a control that is behind disclosures or in a menu, and moves the focus to it. */
export function reveal(control: HTMLElement): void {
  for (let at = control.closest("details"); at != null; at = at.parentElement?.closest("details") ?? null)
    at.open = true;
  control.closest<HTMLElement>("[popover]")?.showPopover();
  control.scrollIntoView({ block: "nearest" });
  control.focus();
  if (control instanceof HTMLInputElement && control.type === "number") control.select();
}
