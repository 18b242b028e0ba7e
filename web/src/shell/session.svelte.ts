import { Refusal, useSession } from "../api/client";
import { beginSession, endSession, putPassword, readSession, readSignInPage } from "../api/session";
import type { Api } from "../api/types";
import { addressOf, router } from "./router.svelte";
import { takeToken } from "./token";

/** The session, and the token of the address if there is one. */
class Session {
  view = $state<Api<"SessionView"> | null>(null);
  /** The session ended: the page stays until the person signs in again. */
  expired = $state(false);
  page = $state<Api<"SignInPage"> | null>(null);
  /** Taken from the address and removed from it at once. */
  token = $state(takeToken());

  #waiting: (() => void)[] = [];

  constructor() {
    // The program's address opened again in the same tab changes the part after `#` only.
    window.addEventListener("hashchange", () => {
      this.token = takeToken(addressOf(router.page)) ?? this.token;
    });
  }

  /** Checks for an existing session. */
  async begin(): Promise<void> {
    this.page = await readSignInPage();
    await this.resume();
  }

  /** Uses the browser's session, which may have begun in another tab. */
  async resume(): Promise<void> {
    try {
      this.#use(await readSession());
    } catch (error) {
      if (!(error instanceof Refusal && error.status === 401)) throw error;
    }
  }

  /** Uses the session that replaced this one; returns whether it belongs to the same person. */
  async renew(): Promise<boolean> {
    const name = this.view?.name;
    await this.resume();
    return this.view?.name === name;
  }

  async signIn(how: Api<"SignIn">): Promise<void> {
    this.#use(await beginSession(how));
    this.token = null;
  }

  /** Changes this account's password: the program gives the browser a new session. */
  async changePassword(change: Api<"PasswordChange">): Promise<void> {
    this.#use(await putPassword(change));
  }

  async signOut(): Promise<void> {
    await endSession();
    // The next person starts at the list of studies.
    router.go({ name: "studies" });
    this.view = null;
    this.expired = false;
  }

  /** The session has ended. */
  expire(): void {
    if (this.view !== null) this.expired = true;
  }

  /** Resolves when a person is signed in again. */
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
