import type { Api } from "../api/types";

const AGAIN_MS = 3_000;

/** Listens to changes of a study by others; the browser reconnects by itself. */
export function hearChanges(
  study: string,
  heard: (change: Api<"Change">) => void,
  /** Called after a reconnection: changes may have been missed. */
  back: () => void,
): () => void {
  const address = `/api/studies/${encodeURIComponent(study)}/changes`;
  let source: EventSource;
  let again: ReturnType<typeof setTimeout> | undefined;
  let wasOpen = false;

  function listen(): void {
    source = new EventSource(address);
    source.addEventListener("open", () => {
      if (wasOpen) back();
      wasOpen = true;
    });
    source.addEventListener("change", (event: MessageEvent<string>) => {
      heard(JSON.parse(event.data) as Api<"Change">);
    });
    // After a refusal, such as after the end of a session, the browser stops; the next request of the page
    // gives the reason.
    source.addEventListener("error", () => {
      if (source.readyState !== EventSource.CLOSED) return;
      if (wasOpen) back();
      wasOpen = false;
      again = setTimeout(listen, AGAIN_MS);
    });
  }

  listen();
  return () => {
    clearTimeout(again);
    source.close();
  };
}
