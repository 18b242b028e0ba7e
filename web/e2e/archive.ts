import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";

const uid = (value: string) => ({ vr: "UI", Value: [value] });

/** A text of a DICOM file in explicit little endian, by its tag and value representation. */
function stated(film: Buffer, group: number, element: number, representation: string): string {
  const tag = Buffer.alloc(4);
  tag.writeUInt16LE(group, 0);
  tag.writeUInt16LE(element, 2);
  const at = film.indexOf(Buffer.concat([tag, Buffer.from(representation)]));
  const size = film.readUInt16LE(at + 6);
  return film.toString("latin1", at + 8, at + 8 + size).replace(/[\0 ]+$/, "");
}

const series = (film: Buffer, patient: string) => [
  {
    "0020000D": uid(stated(film, 0x0020, 0x000d, "UI")),
    "0020000E": uid(stated(film, 0x0020, 0x000e, "UI")),
    "00080020": { vr: "DA", Value: ["20240517"] },
    "00080060": { vr: "CS", Value: ["DX"] },
    "00081030": { vr: "LO", Value: ["Whole spine standing"] },
    "00201209": { vr: "IS", Value: [2] },
    "00100020": { vr: "LO", Value: [patient] },
  },
];

const films = (instance: string) =>
  [instance, "1.2.3.5"].map((one, index) => ({
    "00080018": uid(one),
    "00200013": { vr: "IS", Value: [index + 1] },
    "00280010": { vr: "US", Value: [900] },
    "00280011": { vr: "US", Value: [400] },
  }));

/** A DICOMweb server with one series of two films, of which the second is lost; the patient `locked` is refused. */
export async function startArchive(
  film: Buffer,
): Promise<{ address: string; server: Server; owner: string }> {
  const owner = stated(film, 0x0010, 0x0020, "LO");
  const instance = stated(film, 0x0008, 0x0018, "UI");
  const server = createServer((request, response) => {
    const { pathname, searchParams } = new URL(request.url ?? "", "http://archive");
    const patient = searchParams.get("PatientID");
    const json = (body: unknown) =>
      response.setHeader("content-type", "application/dicom+json").end(JSON.stringify(body));
    if (patient === "locked") response.writeHead(401).end();
    else if (pathname.endsWith("/dicom-web/series"))
      json(patient === owner ? series(film, owner) : []);
    else if (pathname.endsWith("/instances")) json(films(instance));
    else if (pathname.endsWith(`/instances/${instance}`))
      response
        .setHeader("content-type", 'multipart/related; type="application/dicom"; boundary=b')
        .end(
          Buffer.concat([
            Buffer.from("--b\r\nContent-Type: application/dicom\r\n\r\n"),
            film,
            Buffer.from("\r\n--b--\r\n"),
          ]),
        );
    else response.writeHead(404).end();
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address() as AddressInfo;
  return { address: `http://127.0.0.1:${port}/dicom-web`, server, owner };
}
