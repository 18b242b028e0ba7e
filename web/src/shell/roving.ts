import type { Attachment } from "svelte/attachments";

const FOCUSED = "button:not(:disabled)";
const STEPS: Record<string, number> = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

/** Makes the buttons of a group one tab stop; arrows, Home and End go through them. */
export const roving: Attachment<HTMLElement> = (group) => {
  const buttons = (): HTMLElement[] => [...group.querySelectorAll<HTMLElement>(FOCUSED)];
  const settle = (now: Element | null): void => {
    const all = buttons();
    const one = all.find((button) => button === now) ?? stop(all) ?? all[0];
    for (const button of all) button.tabIndex = button === one ? 0 : -1;
  };
  const stop = (all: HTMLElement[]): HTMLElement | undefined =>
    all.find((button) => button.ariaCurrent === "true") ??
    all.find((button) => button.getAttribute("tabindex") === "0");
  const key = (event: KeyboardEvent): void => {
    const all = buttons();
    const here = all.indexOf(event.target as HTMLElement);
    const step = STEPS[event.key];
    const next =
      event.key === "Home"
        ? 0
        : event.key === "End"
          ? all.length - 1
          : step && (here + step + all.length) % all.length;
    if (here < 0 || next === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    all[next]?.focus();
  };
  const focus = (event: FocusEvent): void => settle(event.target as Element);
  const observer = new MutationObserver(() => settle(null));
  observer.observe(group, {
    childList: true,
    subtree: true,
    attributeFilter: ["disabled", "aria-current"],
  });
  group.addEventListener("keydown", key);
  group.addEventListener("focusin", focus);
  settle(null);
  return () => {
    observer.disconnect();
    group.removeEventListener("keydown", key);
    group.removeEventListener("focusin", focus);
  };
};
