import { Refusal, ask, useSession } from "../api/client";
import type { Api } from "../api/types";

/** Who is signed in; the token of the address, if it brought one. */
class Session {
  view = $state<Api<"SessionView"> | null>(null);
  page = $state<Api<"SignInPage"> | null>(null);
  /** Taken from the address when the app starts, and off the address at once. */
  token = $state(takeToken());

  /** Finds out whether somebody is signed in already. */
  async begin(): Promise<void> {
    this.page = await ask("GET", "/api/sign-in");
    try {
      this.#use(await ask("GET", "/api/session"));
    } catch (error) {
      if (!(error instanceof Refusal && error.status === 401)) throw error;
      this.view = null;
    }
  }

  async signIn(how: Api<"SignIn">): Promise<void> {
    this.#use(await ask("POST", "/api/session", { json: how }));
    this.token = null;
  }

  async signOut(): Promise<void> {
    await ask("DELETE", "/api/session");
    this.view = null;
  }

  /** The program no longer knows this session. */
  expire(): void {
    this.view = null;
  }

  #use(view: Api<"SessionView">): void {
    useSession(view);
    this.view = view;
  }
}

function takeToken(): string | null {
  const found = /^#token=([0-9a-f]+)$/.exec(window.location.hash);
  if (!found) return null;
  history.replaceState(null, "", window.location.pathname);
  return found[1] ?? null;
}

export const session = new Session();
