import { describe, expect, it } from "vitest";

import { tokenIn } from "./token";

const TOKEN = "0123456789abcdef0123456789abcdef0123456789abcdef";

describe("tokens", () => {
  it("are found in the printed address and alone", () => {
    expect(tokenIn(`http://127.0.0.1:8765/#token=${TOKEN}`)).toBe(TOKEN);
    expect(tokenIn(`#token=${TOKEN}`)).toBe(TOKEN);
    expect(tokenIn(` ${TOKEN}\n`)).toBe(TOKEN);
  });

  it("are not found in other texts", () => {
    for (const text of ["", "http://127.0.0.1:8765/", "#token=", "#token=xyz", `?token=${TOKEN}`])
      expect(tokenIn(text)).toBeNull();
  });
});
