import type { Attachment } from "svelte/attachments";

const FOCUSED = "button:not(:disabled)";
const STEPS: Record<string, number> = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

/** Makes the buttons of a group one tab stop; arrows, Home and End go through them. */
export const roving: Attachment<HTMLElement> = (group) => {
  const buttons = (): HTMLElement[] => [...group.querySelectorAll<HTMLElement>(FOCUSED)];
  /** The last one with the focus. */
  let last: EventTarget | null = null;
  const settle = (): void => {
    const all = buttons();
    const one =
      all.find((button) => button === document.activeElement) ??
      all.find(({ ariaCurrent }) => ariaCurrent === "true") ??
      all.find((button) => button === last) ??
      all[0];
    for (const button of all) button.tabIndex = button === one ? 0 : -1;
  };
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
  const focus = ({ type, target }: FocusEvent): void => {
    if (type === "focusin") last = target;
    settle();
  };
  const observer = new MutationObserver(settle);
  observer.observe(group, {
    childList: true,
    subtree: true,
    attributeFilter: ["disabled", "aria-current"],
  });
  group.addEventListener("keydown", key);
  group.addEventListener("focusin", focus);
  group.addEventListener("focusout", focus);
  settle();
  return () => {
    observer.disconnect();
    group.removeEventListener("keydown", key);
    group.removeEventListener("focusin", focus);
    group.removeEventListener("focusout", focus);
  };
};
