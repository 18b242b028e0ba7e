/** The page of the app, such as `#/studies/S-017/measure`. Tokens are removed from the address at once. */
export type Page =
  | { name: "studies" }
  | { name: "new-study" }
  | { name: "import" }
  | { name: "measure"; study: string; film?: number }
  | { name: "films"; study: string }
  | { name: "more-films"; study: string }
  | { name: "model"; study: string }
  | { name: "evidence"; study: string }
  | { name: "plan"; study: string }
  | { name: "read"; study: string }
  | { name: "cohort" }
  | { name: "access" };

export function pageOf(hash: string): Page {
  const [first, study, third, fourth] = partsOf(hash);
  if (first === "new") return { name: "new-study" };
  if (first === "import") return { name: "import" };
  if (first === "cohort") return { name: "cohort" };
  if (first === "access") return { name: "access" };
  if (first === "studies" && study) {
    if (third === "films") return { name: "films", study };
    if (third === "more") return { name: "more-films", study };
    if (third === "model") return { name: "model", study };
    if (third === "evidence") return { name: "evidence", study };
    if (third === "plan") return { name: "plan", study };
    if (third === "read") return { name: "read", study };
    const film = Number(fourth);
    return { name: "measure", study, ...(fourth && Number.isInteger(film) ? { film } : {}) };
  }
  return { name: "studies" };
}

function partsOf(hash: string): string[] {
  try {
    return hash.replace(/^#\/?/, "").split("/").map(decodeURIComponent);
  } catch {
    return [];
  }
}

export function addressOf(page: Page): string {
  switch (page.name) {
    case "studies":
      return "#/studies";
    case "new-study":
      return "#/new";
    case "import":
      return "#/import";
    case "cohort":
      return "#/cohort";
    case "access":
      return "#/access";
    case "films":
      return `#/studies/${encodeURIComponent(page.study)}/films`;
    case "more-films":
      return `#/studies/${encodeURIComponent(page.study)}/more`;
    case "model":
      return `#/studies/${encodeURIComponent(page.study)}/model`;
    case "evidence":
      return `#/studies/${encodeURIComponent(page.study)}/evidence`;
    case "plan":
      return `#/studies/${encodeURIComponent(page.study)}/plan`;
    case "read":
      return `#/studies/${encodeURIComponent(page.study)}/read`;
    case "measure": {
      const film = page.film === undefined ? "" : `/${page.film}`;
      return `#/studies/${encodeURIComponent(page.study)}/measure${film}`;
    }
  }
}

/** The address without the film, which a page changes without being created again. */
export const studyAddressOf = (page: Page): string =>
  addressOf(page.name === "measure" ? { name: page.name, study: page.study } : page);

class Router {
  page = $state<Page>(pageOf(window.location.hash));

  constructor() {
    window.addEventListener("hashchange", (event) => {
      // A token is not a page: a person who opens the program's address again stays on the same page.
      if (event.newURL.includes("#token=")) return;
      this.page = pageOf(window.location.hash);
    });
  }

  go(page: Page): void {
    window.location.hash = addressOf(page);
  }

  /** Replaces the current page, so that the browser does not return to it. */
  replace(page: Page): void {
    window.location.replace(addressOf(page));
  }
}

export const router = new Router();
