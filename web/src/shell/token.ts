/** The token in an address, or the text itself if it is a token; null without a token. */
export function tokenIn(text: string): string | null {
  return /(?:^|#token=)([0-9a-f]{16,})$/.exec(text.trim())?.[1] ?? null;
}

/** Replaces the token in the page's address by `place`, so that it is not kept in the history. */
export function takeToken(place = ""): string | null {
  const { hash, pathname } = window.location;
  if (!hash.startsWith("#token=")) return null;
  history.replaceState(null, "", pathname + place);
  return tokenIn(hash);
}
