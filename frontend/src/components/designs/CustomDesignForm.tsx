import {
  ActionIcon,
  Alert,
  Button,
  Group,
  SegmentedControl,
  Select,
  Stack,
  TextInput,
} from "@mantine/core";
import { useState } from "react";
import type { DesignRequest } from "../../api/types";
import {
  AXES,
  EMPTY_DRAFT,
  inputsOf,
  requestOf,
  type DraftInput,
} from "../../lib/drafts/designDraft";
import { useDraft } from "../../lib/drafts/useDraft";
import { NumberField } from "../controls/NumberField";

interface Props {
  busy: boolean;
  onDesign: (request: DesignRequest) => void;
}

const PEAKS = ["Low", "Medium", "High"] as const;

/** Custom design: inputs, bands, target frequencies and power spectrum. */
export function CustomDesignForm({ busy, onDesign }: Props) {
  const { draft, setDraft } = useDraft("own-design", EMPTY_DRAFT);
  const [wrong, setWrong] = useState("");
  const change = (part: Partial<typeof draft>) => {
    setDraft({ ...draft, ...part });
  };
  const changeInput = (index: number, part: Partial<DraftInput>) => {
    change({
      inputs: draft.inputs.map((own, k) => (k === index ? { ...own, ...part } : own)),
    });
  };
  const submit = () => {
    const request = requestOf(draft);
    if (typeof request === "string") {
      setWrong(request);
    } else {
      setWrong("");
      onDesign(request);
    }
  };
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        submit();
      }}
    >
      <Stack gap="sm">
        <Group align="end">
          <TextInput
            label="Name"
            required
            maxLength={200}
            value={draft.name}
            onChange={(event) => {
              change({ name: event.currentTarget.value });
            }}
          />
          <Positive
            label="Duration"
            unit="s"
            value={draft.duration}
            onChange={(duration) => {
              change({ duration });
            }}
          />
          <Positive
            label="Rate [Hz]"
            value={draft.rate}
            onChange={(rate) => {
              change({ rate });
            }}
          />
          {PEAKS.map((label, index) => (
            <Positive
              key={label}
              label={label}
              unit="deg"
              value={draft.peaks[index] ?? 1}
              onChange={(value) => {
                const peaks: typeof draft.peaks = [...draft.peaks];
                peaks[index] = value;
                change({ peaks });
              }}
            />
          ))}
          <Select
            label="Search"
            w={120}
            allowDeselect={false}
            data={["quick", "thorough", "patient"]}
            value={draft.effort}
            onChange={(effort) => {
              if (effort === "quick" || effort === "thorough" || effort === "patient")
                change({ effort });
            }}
          />
        </Group>
        <Group align="end">
          <TextInput
            label="Surfaces in harmonic order"
            w={280}
            value={draft.surfaces}
            onChange={(event) => {
              change({ surfaces: event.currentTarget.value });
            }}
          />
          <SegmentedControl
            aria-label="Surface combination"
            data={[...AXES]}
            value={draft.axis}
            onChange={(value) => {
              const axis = AXES.find((one) => one === value);
              if (axis !== undefined) change({ axis });
            }}
          />
          <Button
            variant="default"
            onClick={() => {
              change({ inputs: [...draft.inputs, ...inputsOf(draft)] });
            }}
          >
            Add inputs
          </Button>
          <Button
            variant="default"
            onClick={() => {
              const throttle = { ...inputsOf({ ...EMPTY_DRAFT, surfaces: "x" })[0] } as DraftInput;
              const inputs = [
                ...draft.inputs,
                { ...throttle, name: "throttle", low: 0.05, high: 0.3, count: 2 },
              ];
              change({ inputs });
            }}
          >
            Add a throttle
          </Button>
        </Group>
        {draft.inputs.length > 0 && (
          <div className="table-scroll">
            <table className="data-table" aria-label="Inputs" data-testid="own-inputs">
              <thead>
                <tr>
                  <th scope="col">Input</th>
                  <th scope="col">
                    From <span className="unit">[Hz]</span>
                  </th>
                  <th scope="col">
                    To <span className="unit">[Hz]</span>
                  </th>
                  <th scope="col">Harmonics</th>
                  <th scope="col">Relative peak</th>
                  <th scope="col">
                    Half of the harmonics near <span className="unit">[Hz]</span>
                  </th>
                  <th scope="col">
                    Power spectrum, flat if empty <span className="unit">[Hz:1]</span>
                  </th>
                  <th scope="col" aria-label="Remove" />
                </tr>
              </thead>
              <tbody>
                {draft.inputs.map((own, index) => (
                  <tr key={index}>
                    <td>
                      <TextInput
                        aria-label="Name of the input"
                        w={110}
                        value={own.name}
                        onChange={(event) => {
                          changeInput(index, { name: event.currentTarget.value });
                        }}
                      />
                    </td>
                    {(["low", "high", "count", "relative"] as const).map((field) => (
                      <td key={field}>
                        <Positive
                          ariaLabel={`${own.name}: ${field}`}
                          value={own[field]}
                          onChange={(value) => {
                            changeInput(index, { [field]: value });
                          }}
                        />
                      </td>
                    ))}
                    {(["targets", "spectrum"] as const).map((field) => (
                      <td key={field}>
                        <TextInput
                          aria-label={`${own.name}: ${field}`}
                          placeholder={field === "targets" ? "3.2, 10.5" : "0.3:1, 12:0.01"}
                          value={own[field]}
                          onChange={(event) => {
                            changeInput(index, { [field]: event.currentTarget.value });
                          }}
                        />
                      </td>
                    ))}
                    <td>
                      <ActionIcon
                        variant="subtle"
                        color="gray"
                        aria-label={`Remove ${own.name}`}
                        onClick={() => {
                          change({ inputs: draft.inputs.filter((_, k) => k !== index) });
                        }}
                      >
                        ×
                      </ActionIcon>
                    </td>
                  </tr>
                ))}
              </tbody>
            </table>
          </div>
        )}
        {wrong !== "" && (
          <Alert color="red" variant="light">
            {wrong}
          </Alert>
        )}
        <Group>
          <Button type="submit" loading={busy} disabled={draft.inputs.length === 0}>
            Design
          </Button>
        </Group>
      </Stack>
    </form>
  );
}

interface PositiveProps {
  label?: string;
  ariaLabel?: string;
  unit?: string;
  value: number;
  onChange: (value: number) => void;
}

function Positive({ ariaLabel, onChange, ...field }: PositiveProps) {
  return (
    <NumberField
      {...field}
      aria-label={ariaLabel}
      isPositive
      w={100}
      onChange={(next) => {
        if (next !== undefined) onChange(next);
      }}
    />
  );
}
