import { expect, it } from "vitest";

import { Loaded } from "./loaded.svelte";

it("keeps the answer to the newest request, also where an older one is slower", async () => {
  const answers: ((value: string) => void)[] = [];
  const loaded = new Loaded(() => new Promise<string>((resolve) => answers.push(resolve)));
  const loads = [loaded.load(), loaded.load()];
  answers[1]!("new");
  answers[0]!("old");
  await Promise.all(loads);
  expect(loaded.value).toBe("new");
});
