import { openArchiveFilm } from "../api/archives";
import { uploadFile } from "../api/client";
import { discardUpload } from "../api/studies";
import type { Api } from "../api/types";

const AT_ONCE = 3;

/** A way to bring a film to the program; reports the fraction sent, if known. */
type Way = (onsent: (fraction: number) => void, signal: AbortSignal) => Promise<Api<"UploadView">>;

/** A film that is being sent to the program. */
export class Sent {
  /** Fraction sent, 0 to 1; null if unknown. */
  fraction = $state<number | null>(null);
  /** Content of the file as the program read it. */
  view = $state.raw<Api<"UploadView"> | null>(null);
  /** Why the program refused it. */
  error = $state.raw<unknown>(null);

  readonly #stop = new AbortController();

  constructor(
    readonly key: number,
    readonly name: string,
    private readonly way: Way,
    /** The failed action. */
    readonly what: string,
  ) {}

  get waiting(): boolean {
    return this.view === null && this.error === null;
  }

  async send(): Promise<void> {
    this.error = null;
    try {
      this.view = await this.way((fraction) => {
        this.fraction = fraction;
      }, this.#stop.signal);
    } catch (caught) {
      this.error = caught;
    }
  }

  stop(): void {
    this.#stop.abort();
  }
}

/** Uploads, a few at the same time. */
export class Uploads {
  all = $state<Sent[]>([]);

  #next = 0;
  #under_way = 0;
  #queue: Sent[] = [];
  readonly #used = new Set<string>();

  /** `ready` is called with every accepted file. */
  constructor(private readonly ready: (sent: Sent) => void = () => undefined) {}

  add(files: Iterable<File>): void {
    for (const file of files)
      this.#add(
        file.name,
        (onsent, signal) => uploadFile(file, onsent, signal),
        "This file was not accepted",
      );
  }

  /** Opens a film of an archive. */
  open(name: string, film: Api<"ArchiveFilmChoice">): void {
    this.#add(name, (_, signal) => openArchiveFilm(film, signal), "This film was not opened");
  }

  again(sent: Sent): void {
    sent.error = null;
    this.#queue.push(sent);
    this.#go();
  }

  remove(sent: Sent): void {
    sent.stop();
    this.#queue = this.#queue.filter((other) => other !== sent);
    this.all = this.all.filter((other) => other !== sent);
    // The program would forget it later; until then it takes scarce room.
    const upload = sent.view?.upload;
    if (upload !== undefined && !this.#used.has(upload))
      void discardUpload(upload).catch(() => undefined);
  }

  /** These are in a study now, and no longer uploads. */
  used(uploads: Iterable<string>): void {
    for (const upload of uploads) this.#used.add(upload);
  }

  /** The page is left: uploads without a study are not needed. */
  close(): void {
    for (const sent of [...this.all]) this.remove(sent);
  }

  #add(name: string, way: Way, what: string): void {
    const sent = new Sent(this.#next++, name, way, what);
    this.all.push(sent);
    this.#queue.push(sent);
    this.#go();
  }

  #go(): void {
    while (this.#under_way < AT_ONCE) {
      const sent = this.#queue.shift();
      if (!sent) return;
      this.#under_way += 1;
      void sent.send().then(() => {
        this.#under_way -= 1;
        if (sent.view) this.ready(sent);
        this.#go();
      });
    }
  }
}
