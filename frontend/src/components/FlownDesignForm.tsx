import {
  Alert,
  Button,
  Checkbox,
  FileInput,
  Group,
  NumberInput,
  Select,
  TextInput,
} from "@mantine/core";
import { useState } from "react";
import { useImportFlown } from "../api/commands";
import { ProblemAlert } from "./ProblemAlert";

/** Waveforms of a flight computer are recognised and kept as designs. */
export function FlownDesignForm() {
  const flown = useImportFlown();
  const [files, setFiles] = useState<File[]>([]);
  const [name, setName] = useState("");
  const [rate, setRate] = useState(100);
  const [unit, setUnit] = useState("deg");
  const [apart, setApart] = useState(false);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        flown.mutate({ files, name: name === "" ? "Flown" : name, rate, unit, apart });
      }}
    >
      <Group align="end">
        <FileInput
          label="Files, one whole period each"
          placeholder="Choose files"
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
          disabled={apart}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <NumberInput
          label="Rate [Hz]"
          w={100}
          min={0.1}
          value={rate}
          onChange={(next) => {
            if (typeof next === "number" && next > 0) setRate(next);
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
          label="Each file is a design of its own"
          mb={6}
          checked={apart}
          onChange={(event) => {
            setApart(event.currentTarget.checked);
          }}
        />
        <Button type="submit" loading={flown.isPending} disabled={files.length === 0}>
          Recognise
        </Button>
      </Group>
      {flown.isError && <ProblemAlert error={flown.error} />}
      {flown.isSuccess && (
        <Alert color="teal" variant="light" mt="sm" data-testid="flown-kept">
          Recognised and kept: {flown.data.map((design) => design.name).join(", ")}. Open one to see
          its lines, and search its phases anew there.
        </Alert>
      )}
    </form>
  );
}
