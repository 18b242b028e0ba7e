// Tests run outside of a browser, but requests need the address of a page, and the shell listens to its window.
globalThis.location = new URL("http://127.0.0.1:8765/") as unknown as Location;
globalThis.window = Object.assign(new EventTarget(), {
  location: globalThis.location,
}) as unknown as Window & typeof globalThis;
