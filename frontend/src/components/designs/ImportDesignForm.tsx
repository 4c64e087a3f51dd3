import { Alert, Button, Checkbox, FileInput, Group, Select, TextInput } from "@mantine/core";
import { useState } from "react";
import { useImportFlown } from "../../api/commands";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";

/** Import of flown waveforms as designs. */
export function ImportDesignForm() {
  const flown = useImportFlown();
  const [files, setFiles] = useState<File[]>([]);
  const [name, setName] = useState("");
  const [rate, setRate] = useState(100);
  const [unit, setUnit] = useState("deg");
  const [separate, setSeparate] = useState(false);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        flown.mutate({ files, name: name === "" ? "Flown" : name, rate, unit, separate });
      }}
    >
      <Group align="end">
        <FileInput
          label="Files, one full period each"
          placeholder="Select files"
          multiple
          w={280}
          value={files}
          onChange={setFiles}
        />
        <TextInput
          label="Name"
          placeholder="Flown"
          maxLength={200}
          value={name}
          disabled={separate}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <NumberField
          label="Rate [Hz]"
          w={100}
          isPositive
          value={rate}
          onChange={(next) => {
            if (next !== undefined) setRate(next);
          }}
        />
        <Select
          label="Unit"
          w={90}
          allowDeselect={false}
          data={["deg", "rad"]}
          value={unit}
          onChange={(next) => {
            setUnit(next ?? "deg");
          }}
        />
        <Checkbox
          label="One design per file"
          mb={6}
          checked={separate}
          onChange={(event) => {
            setSeparate(event.currentTarget.checked);
          }}
        />
        <Button type="submit" loading={flown.isPending} disabled={files.length === 0}>
          Import
        </Button>
      </Group>
      {flown.isError && <ProblemAlert error={flown.error} />}
      {flown.isSuccess && (
        <Alert color="teal" variant="light" mt="sm" data-testid="flown-saved">
          Imported: {flown.data.map((design) => design.name).join(", ")}. Open a design to view its
          harmonics and re-optimise its phases.
        </Alert>
      )}
    </form>
  );
}
