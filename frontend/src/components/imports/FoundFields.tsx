import { List, Spoiler, Text } from "@mantine/core";
import type { UploadDetail } from "../../api/types";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Section } from "../display/Section";

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
  const notRead = found.files.flatMap((file) =>
    file.not_read.map((text) => (found.files.length > 1 ? `${file.name}: ${text}` : text)),
  );
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
      {notRead.length > 0 && (
        <Spoiler
          maxHeight={96}
          showLabel={`Show all ${notRead.length}`}
          hideLabel="Show fewer"
          data-testid="not-read"
        >
          <Text size="sm" fw={600} mt="xs">
            Not read
          </Text>
          <List size="sm">
            {notRead.map((text) => (
              <List.Item key={text}>{text}</List.Item>
            ))}
          </List>
        </Spoiler>
      )}
    </Section>
  );
}
