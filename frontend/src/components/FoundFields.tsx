import { Text } from "@mantine/core";
import type { UploadDetail } from "../api/types";
import { DataTable, numeric, type Column } from "./DataTable";
import { Section } from "./Section";

type Found = UploadDetail["fields"][number];

const short = (value: number | null) => (value === null ? "–" : Number(value.toPrecision(5)));

const COLUMNS: Column<Found>[] = [
  { key: "file", header: "File", render: (found) => found.file },
  { key: "field", header: "Column", render: (found) => found.field },
  { key: "unit", header: "Unit in the file", render: (found) => found.unit },
  { key: "n", header: "Samples", numeric: true, render: (found) => found.n_samples },
  numeric("rate", "Rate", (found) => short(found.rate_hz), "Hz"),
  {
    key: "first",
    header: "First values",
    render: (found) => found.first.map((value) => short(value)).join(", "),
  },
  { key: "least", header: "Smallest", numeric: true, render: (found) => short(found.smallest) },
  { key: "most", header: "Largest", numeric: true, render: (found) => short(found.largest) },
];

/** Contents of the files of an upload. */
export function FoundFields({ found }: { found: UploadDetail }) {
  return (
    <Section
      title="File contents"
      note={found.files.map((file) => `${file.name}: ${file.n_fields} fields`).join(" · ")}
    >
      {found.fields.length > 0 ? (
        <DataTable
          columns={COLUMNS}
          rows={found.fields}
          rowKey={(own) => `${own.file}:${own.field}`}
          label="Columns of the files"
          testId="found-fields"
          maxHeight={260}
        />
      ) : (
        <Text size="sm">No columns of samples in the files.</Text>
      )}
    </Section>
  );
}
