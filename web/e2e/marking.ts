import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import {
  cssOf,
  filmOf,
  type CssPoint,
  type FilmPoint,
  type Viewport,
} from "../src/measure/viewport";
import { expect, type App } from "./app";
import { send } from "./wire";

type ReadingView = Api<"ReadingView">;
type Corner = Api<"CornerName">;

export { LEVELS } from "./levels";

export const CORNERS: readonly Corner[] = [
  "superior_left",
  "superior_right",
  "inferior_right",
  "inferior_left",
];

/** The measuring page, used like a person does. */
export class FilmPage {
  constructor(readonly page: Page) {}

  /** Opens the demo study and begins a reading of its erect film. */
  static async ofDemo(app: App, page: Page): Promise<FilmPage> {
    await app.openDemo(page);
    const film = new FilmPage(page);
    await film.begin();
    return film;
  }

  async begin(): Promise<void> {
    await this.page.getByRole("button", { name: /^start marking/i }).click({ timeout: 90_000 });
    await expect(this.target).toContainText("L4", { timeout: 60_000 });
    await this.painted();
  }

  get viewer() {
    return this.page.getByTestId("viewer").first();
  }

  get target() {
    return this.page.getByTestId("target");
  }

  async saved(): Promise<void> {
    await expect(this.page.getByTestId("saving")).toHaveAttribute("data-state", "saved");
  }

  /** Waits until the film is on the canvas, which is black before. */
  async painted(): Promise<void> {
    // The middle is enough: reading a whole canvas back takes half a second.
    const isDrawn = (): Promise<boolean> =>
      this.page
        .getByTestId("film")
        .first()
        .evaluate((element) => {
          const canvas = element as HTMLCanvasElement;
          const side = 160;
          const [left, top] = [(canvas.width - side) / 2, (canvas.height - side) / 2];
          const { data } = canvas.getContext("2d")!.getImageData(left, top, side, side);
          const greys = new Set<number>();
          for (let i = 0; i < data.length; i += 4) greys.add(data[i]!);
          return greys.size > 32;
        });
    await expect.poll(isDrawn, { timeout: 60_000, intervals: [50, 100] }).toBe(true);
  }

  async view(): Promise<Viewport> {
    return JSON.parse((await this.viewer.getAttribute("data-view"))!) as Viewport;
  }

  /** Place on the page of a point of the film. */
  async where(place: FilmPoint): Promise<[number, number]> {
    const [view, box] = [await this.view(), (await this.viewer.boundingBox())!];
    const [x, y] = cssOf(view, place);
    return [box.x + x, box.y + y];
  }

  /** Zooms with the wheel to the requested width of a film pixel, centred on a place. */
  async lookAt(place: FilmPoint, scale: number): Promise<void> {
    await this.page.getByRole("button", { name: "Fit" }).click();
    while ((await this.view()).scale < scale) {
      const before = (await this.view()).scale;
      await this.page.mouse.move(...(await this.where(place)));
      await this.page.mouse.wheel(0, -200);
      await expect.poll(async () => (await this.view()).scale).toBeGreaterThan(before);
    }
    // To the middle, so that its neighbours are visible too.
    const box = (await this.viewer.boundingBox())!;
    await this.page.mouse.move(...(await this.where(place)));
    await this.page.mouse.down({ button: "middle" });
    await this.page.mouse.move(box.x + box.width / 2, box.y + box.height / 2, { steps: 4 });
    await this.page.mouse.up({ button: "middle" });
  }

  async click(place: FilmPoint): Promise<FilmPoint> {
    const [x, y] = await this.where(place);
    await this.page.mouse.click(x, y);
    const box = (await this.viewer.boundingBox())!;
    return filmOf(await this.view(), [x - box.x, y - box.y]);
  }

  /** Places the corners of a vertebra from another reading in the requested order. */
  async mark(truth: ReadingView, level: string): Promise<void> {
    for (const corner of CORNERS) {
      await expect(this.target).toContainText(level);
      await expect(this.target).toContainText(wordsOf(corner));
      await this.click(cornerOf(truth, level, corner));
    }
  }

  /** Places both walls of the requested vertebra from another reading. */
  async markWalls(truth: ReadingView, level: string): Promise<void> {
    for (const side of ["left", "right"] as const) {
      await expect(this.target).toContainText(level);
      await expect(this.target).toContainText(`patient’s ${side}`);
      await this.click(wallOf(truth, level, side));
    }
  }

  /** Places L4, the first requested vertebra, as a square in the middle of the film. */
  async markSquare(image: Api<"FilmImage">): Promise<void> {
    const left = image.patient_left === "image_left" ? -1 : 1;
    for (const corner of CORNERS) {
      await expect(this.target).toContainText(wordsOf(corner));
      const x = corner.endsWith("left") ? left : -left;
      const y = corner.startsWith("superior") ? -1 : 1;
      await this.click([image.columns / 2 + 150 * x, image.rows / 2 + 100 * y]);
    }
    await expect(this.target).toContainText("L3");
    await this.saved();
  }

  /**
   * Largest difference between the grey on the screen in the middle of a film pixel and the grey of its brightness, when
   * enlarged. A device pixel may lie half a pixel beside the middle, where a neighbour contributes.
   */
  async worstGrey(): Promise<number> {
    const [view, { film }] = [await this.view(), await this.reading()];
    const middles: { at: CssPoint; px: FilmPoint }[] = [];
    for (let x = 40; x < 400; x += 9)
      for (let y = 60; y < 400; y += 9) {
        const [column, row] = filmOf(view, [x, y]);
        const px = [Math.round(column), Math.round(row)] as const;
        middles.push({ at: cssOf(view, px), px });
      }
    const canvas = this.page.getByTestId("film");
    const differences = await canvas.evaluate(
      async (element, { middles, film }) => {
        const response = await fetch(`/api/films/${film}/pixels`);
        const header = (name: string) => Number(response.headers.get(`x-spineline-${name}`));
        const values = new Uint16Array(await response.arrayBuffer());
        const { width, height } = element as HTMLCanvasElement;
        const context = (element as HTMLCanvasElement).getContext("2d")!;
        const lowest = header("window-center") - header("window-width") / 2;
        return middles.flatMap(({ at, px: [column, row] }) => {
          const [x, y] = at.map((css) => Math.floor(css * window.devicePixelRatio));
          if (x! >= width || y! >= height) return [];
          const value = values[row * header("columns") + column]!;
          const share = Math.min(1, Math.max(0, (value - lowest) / header("window-width")));
          return Math.abs(context.getImageData(x!, y!, 1, 1).data[0]! - 255 * share);
        });
      },
      { middles, film },
    );
    expect(differences.length).toBeGreaterThan(500);
    return Math.max(...differences);
  }

  /** Drags from one place to another. */
  async drag(from: FilmPoint, to: FilmPoint): Promise<void> {
    await this.page.mouse.move(...(await this.where(from)));
    await this.page.mouse.down();
    await this.page.mouse.move(...(await this.where(to)), { steps: 8 });
    await this.page.mouse.up();
  }

  /** Records the corners of levels without clicks; a new reading has revision 0. */
  async record(
    levels: readonly string[],
    placeOf: (level: string, corner: Corner) => FilmPoint,
    expected_revision = 0,
  ): Promise<void> {
    const { reading } = await this.reading();
    const events = levels.flatMap((level) =>
      CORNERS.map((corner): Api<"Event"> => {
        const [column_px, row_px] = placeOf(level, corner);
        return { kind: "place_corner", level, corner, column_px, row_px };
      }),
    );
    const body = { expected_revision, events };
    const sent = await send(this.page, "POST", `/api/readings/${reading}/events`, body);
    expect(sent.status, JSON.stringify(sent.body).slice(0, 400)).toBe(200);
  }

  /** Finishes the reading. */
  async finish(): Promise<void> {
    await this.page.getByRole("button", { name: /finish reading/i }).click();
    const dialog = this.page.getByRole("dialog", { name: /finish this reading/i });
    await dialog.getByRole("button", { name: "Finish", exact: true }).click();
    await expect(dialog).toBeHidden();
  }

  /** The current reading as the program has it. */
  async reading(): Promise<ReadingView> {
    const detail = await this.detail();
    const number = Number(/measure\/(\d+)/.exec(this.page.url())?.[1] ?? Number.NaN);
    const film =
      detail.summary.films.find((one) => one.film === number) ??
      detail.summary.films.find(({ posture }) => posture === "erect")!;
    const mine = film.readings.filter((one) => one.mine).toSorted((a, b) => b.reading - a.reading);
    return this.get(`/api/readings/${mine[0]!.reading}`);
  }

  /** A reading of the erect film by one of the demo's virtual readers. */
  async truth(): Promise<ReadingView> {
    const detail = await this.detail();
    const erect = detail.summary.films.find(({ posture }) => posture === "erect")!;
    const other = erect.readings.find((one) => !one.mine && one.complete_levels === 15)!;
    return this.get(`/api/readings/${other.reading}`);
  }

  detail(): Promise<Api<"StudyDetail">> {
    const study = /studies\/([^/]+)/.exec(this.page.url())![1]!;
    return this.get(`/api/studies/${study}`);
  }

  get<T>(path: string): Promise<T> {
    return this.page.evaluate(async (address) => (await fetch(address)).json(), path);
  }
}

export function cornerOf(reading: ReadingView, level: string, corner: Corner): FilmPoint {
  const vertebra = reading.vertebrae.find((one) => one.level === level);
  const px = vertebra?.corners.find((one) => one.corner === corner)?.px;
  if (!px) throw new Error(`${level} lacks ${corner}`);
  return [px[0]!, px[1]!];
}

function wordsOf(corner: Corner): RegExp {
  const [endplate, side] = corner.split("_");
  return new RegExp(`${endplate} endplate, patient.s ${side}`);
}

/** Maximum distance between corners of two readings, over the levels of the first. */
export function farthest(a: ReadingView, b: ReadingView): number {
  const distances = a.vertebrae.flatMap(({ level, corners }) =>
    corners.map(({ corner, px }) => {
      const [column, row] = cornerOf(b, level, corner);
      return Math.hypot(px[0]! - column, px[1]! - row);
    }),
  );
  return Math.max(...distances);
}

/** The middle of a wall of another reading. */
export function wallOf(truth: ReadingView, level: string, side: "left" | "right"): FilmPoint {
  const above = cornerOf(truth, level, `superior_${side}`);
  const below = cornerOf(truth, level, `inferior_${side}`);
  return [(above[0] + below[0]) / 2, (above[1] + below[1]) / 2];
}
