/** Addresses of pages without a study. */
const ALONE = {
  studies: "studies",
  "new-study": "new",
  import: "import",
  cohort: "cohort",
  access: "access",
} as const;

/** Ends of the addresses of a study's pages. */
const OF_STUDY = {
  films: "films",
  "more-films": "more",
  model: "model",
  evidence: "evidence",
  plan: "plan",
  read: "read",
} as const;

/** The page of the app, such as `#/studies/S-017/measure`. Tokens are removed from the address at once. */
export type Page =
  | { name: keyof typeof ALONE }
  | { name: keyof typeof OF_STUDY; study: string }
  | { name: "measure"; study: string; film?: number };

export function pageOf(hash: string): Page {
  const [first, study, third, fourth] = partsOf(hash);
  if (first !== "studies" || !study) return { name: nameAt(ALONE, first) ?? "studies" };
  const name = nameAt(OF_STUDY, third);
  if (name) return { name, study };
  const film = Number(fourth);
  return { name: "measure", study, ...(fourth && Number.isInteger(film) ? { film } : {}) };
}

const nameAt = <Name extends string>(
  pages: Record<Name, string>,
  address: string | undefined,
): Name | undefined => (Object.keys(pages) as Name[]).find((name) => pages[name] === address);

function partsOf(hash: string): string[] {
  try {
    return hash.replace(/^#\/?/, "").split("/").map(decodeURIComponent);
  } catch {
    return [];
  }
}

export function addressOf(page: Page): string {
  if (!("study" in page)) return `#/${ALONE[page.name]}`;
  const study = `#/studies/${encodeURIComponent(page.study)}`;
  if (page.name !== "measure") return `${study}/${OF_STUDY[page.name]}`;
  return page.film === undefined ? `${study}/measure` : `${study}/measure/${page.film}`;
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
