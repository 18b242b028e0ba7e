import { Refusal, useSession } from "../api/client";
import { beginSession, endSession, readSession, readSignInPage } from "../api/session";
import type { Api } from "../api/types";
import { addressOf, router } from "./router.svelte";
import { takeToken } from "./token";

/** Who is signed in; the token of the address, if it brought one. */
class Session {
  view = $state<Api<"SessionView"> | null>(null);
  /** The session ended while somebody worked: their page stays where it is until they are back. */
  expired = $state(false);
  page = $state<Api<"SignInPage"> | null>(null);
  /** Taken from the address, and off the address at once. */
  token = $state(takeToken());

  #waiting: (() => void)[] = [];

  constructor() {
    // The program's address opened again in the same tab changes nothing but what stands behind `#`.
    window.addEventListener("hashchange", () => {
      this.token = takeToken(addressOf(router.page)) ?? this.token;
    });
  }

  /** Finds out whether somebody is signed in already. */
  async begin(): Promise<void> {
    this.page = await readSignInPage();
    await this.resume();
  }

  /** Takes up a session that the browser knows of, such as one begun in another tab. */
  async resume(): Promise<void> {
    try {
      this.#use(await readSession());
    } catch (error) {
      if (!(error instanceof Refusal && error.status === 401)) throw error;
    }
  }

  /** Takes up the session that took the place of this one; answers whether it is the same person's. */
  async renew(): Promise<boolean> {
    const name = this.view?.name;
    await this.resume();
    return this.view?.name === name;
  }

  async signIn(how: Api<"SignIn">): Promise<void> {
    this.#use(await beginSession(how));
    this.token = null;
  }

  async signOut(): Promise<void> {
    await endSession();
    // Whoever comes next begins at the beginning.
    router.go({ name: "studies" });
    this.view = null;
    this.expired = false;
  }

  /** The program no longer knows this session. */
  expire(): void {
    if (this.view !== null) this.expired = true;
  }

  /** Settles when somebody is signed in again. */
  back(): Promise<void> {
    if (!this.expired) return Promise.resolve();
    return new Promise((resolve) => this.#waiting.push(resolve));
  }

  #use(view: Api<"SessionView">): void {
    useSession(view);
    this.view = view;
    this.expired = false;
    for (const resolve of this.#waiting.splice(0)) resolve();
  }
}

export const session = new Session();
