import type { Api } from "../api/types";

/** Hears what others do in a study; the browser asks again by itself when the program was away. */
export function hearChanges(
  study: string,
  heard: (change: Api<"Change">) => void,
  /** The program is back: something may have been missed. */
  back: () => void,
): () => void {
  const source = new EventSource(`/api/studies/${encodeURIComponent(study)}/changes`);
  let wasOpen = false;
  source.addEventListener("open", () => {
    if (wasOpen) back();
    wasOpen = true;
  });
  source.addEventListener("change", (event: MessageEvent<string>) => {
    heard(JSON.parse(event.data) as Api<"Change">);
  });
  return () => source.close();
}
