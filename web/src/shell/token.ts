/** The token in an address, or a token by itself; null if there is none. */
export function tokenIn(text: string): string | null {
  return /(?:^|#token=)([0-9a-f]{16,})$/.exec(text.trim())?.[1] ?? null;
}

/** Takes the token off the page's address, so that it stays in no history; `place` takes its room. */
export function takeToken(place = ""): string | null {
  const { hash, pathname } = window.location;
  if (!hash.startsWith("#token=")) return null;
  history.replaceState(null, "", pathname + place);
  return tokenIn(hash);
}
