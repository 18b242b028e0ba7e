import type { Api } from "../api/types";
import type { PointerMode } from "../measure/gestures";
import type { Viewer } from "../measure/viewer.svelte";
import type { CssPoint, FilmPoint } from "../measure/viewport";
import { nearestSite } from "./sites";

/** Clicks pick places on the curve. */
export class Picker implements PointerMode {
  readonly magnifies = false;

  constructor(
    readonly viewer: Viewer,
    readonly sites: readonly Api<"SitePoint">[],
    readonly pick: (site: string) => void,
  ) {}

  press(): void {}
  drag(): void {}
  abandon(): void {}

  release(at: CssPoint, far: boolean): void {
    const places = this.sites.map(({ site, px }) => ({ site, at: this.viewer.at(px) }));
    const site = nearestSite(places, at);
    if (site && !far) this.pick(site);
  }

  placeAt(at: FilmPoint): void {
    this.release(this.viewer.at(at), false);
  }
}
