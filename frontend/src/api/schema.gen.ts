// Written by `npm run generate` from the API itself; do not edit.

export interface paths {
    "/api/v1/health": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Health
         * @description Return the state of server, database, dispatcher and workers.
         *
         *     The status is `degraded` (200) if runs cannot be processed or the clock is wrong: a restart of
         *     the server would not help. If the database does not respond, the status code is 503.
         */
        get: operations["get_health"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Aircraft
         * @description List all aircraft.
         */
        get: operations["list_aircraft"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft/{aircraft_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Aircraft
         * @description Return one aircraft.
         */
        get: operations["get_aircraft"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/aircraft/{aircraft_id}/thrust": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Set Thrust
         * @description Set the thrust table of an aircraft, from which the thrust of new maneuvers is computed.
         */
        put: operations["set_thrust"];
        post?: never;
        /**
         * Remove Thrust
         * @description Delete the thrust table of an aircraft; the thrust of existing maneuvers is unchanged.
         */
        delete: operations["remove_thrust"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flights
         * @description List flights, of one aircraft or of all.
         */
        get: operations["list_flights"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flight
         * @description Return one flight.
         */
        get: operations["get_flight"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/channels": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flight Channels
         * @description List the channels of the recording of a flight.
         */
        get: operations["list_flight_channels"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/found-maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Find Maneuvers
         * @description Detect maneuvers in the recording of a flight; nothing is stored.
         */
        get: operations["find_maneuvers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flights/{flight_id}/maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cut Maneuver
         * @description Cut a maneuver from a window of the recording, which is not changed.
         */
        post: operations["cut_maneuver"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/ground-tests": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Ground Tests
         * @description Compare the mini-GVT records before and after every flight that has both.
         */
        get: operations["list_ground_tests"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/ground-tests/{flight_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Ground Test
         * @description Compare the mini-GVT records before and after one flight.
         */
        get: operations["get_ground_test"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuvers
         * @description List maneuvers with their condition and the newest run of each method.
         */
        get: operations["list_maneuvers"];
        put?: never;
        /**
         * Upload Maneuver
         * @description Import a maneuver from files, completely or not at all.
         */
        post: operations["upload_maneuver"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/facets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuver Facets
         * @description Return the number of maneuvers, in total and for each value of each filter.
         */
        get: operations["list_maneuver_facets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/changes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Change Maneuvers
         * @description Delete, restore, tag or untag many maneuvers; all of them, or none.
         *
         *     The response lists the changed ids: the opposite action on them undoes the change.
         */
        post: operations["change_maneuvers"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Maneuver
         * @description Return one maneuver with its channels.
         */
        get: operations["get_maneuver"];
        put?: never;
        post?: never;
        /**
         * Delete Maneuver
         * @description Delete a maneuver with its runs; it can be restored.
         */
        delete: operations["delete_maneuver"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/run-proposal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Proposal
         * @description Propose modes, inputs, outputs and band of a run, with their requirements on the data.
         *
         *     A run requested without a structure uses this proposal.
         */
        get: operations["get_run_proposal"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/quality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Quality
         * @description Return the data quality of a maneuver; it is assessed now if it was not before.
         */
        get: operations["get_quality"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/conditioning": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Conditioning
         * @description List the corrections of a maneuver, including undone ones.
         */
        get: operations["list_conditioning"];
        put?: never;
        /**
         * Add Conditioning
         * @description Apply corrections, all or none; the recorded data are not changed.
         */
        post: operations["add_conditioning"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuvers/{maneuver_id}/conditioning/{step_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Undo Conditioning
         * @description Undo a correction; it remains in the list.
         */
        delete: operations["undo_conditioning"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/quality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Qualities
         * @description List maneuvers with their stored verdict, by default the worst first.
         */
        get: operations["list_qualities"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/quality/assess": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Assess Maneuvers
         * @description Start assessing the data quality of the given maneuvers, or of all unassessed ones.
         */
        post: operations["assess_maneuvers"];
        /**
         * Stop Assessment
         * @description Stop the assessment; remaining maneuvers stay unassessed.
         */
        delete: operations["stop_assessment"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/mappings": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Mappings
         * @description List stored mappings.
         */
        get: operations["list_mappings"];
        put?: never;
        /**
         * Add Mapping
         * @description Store a mapping under a name; a mapping of the same name is replaced.
         */
        post: operations["add_mapping"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/mappings/{mapping_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Mapping
         * @description Return one mapping.
         */
        get: operations["get_mapping"];
        put?: never;
        post?: never;
        /**
         * Delete Mapping
         * @description Delete a mapping; data imported with it are unchanged.
         */
        delete: operations["delete_mapping"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Imports
         * @description List the uploads that are being imported or queued.
         */
        get: operations["list_imports"];
        put?: never;
        /**
         * Upload Files
         * @description Read files and propose a mapping; nothing is stored in the database.
         */
        post: operations["upload_files"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Upload
         * @description Return the contents of the files of an upload, and the proposed mapping.
         */
        get: operations["get_upload"];
        put?: never;
        post?: never;
        /**
         * Delete Upload
         * @description Cancel an import, or delete the files; imported data remain.
         */
        delete: operations["delete_upload"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/state": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Upload State
         * @description Return the progress of an import.
         */
        get: operations["get_upload_state"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/check": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Check Upload
         * @description Check a mapping against the files; nothing is stored.
         */
        post: operations["check_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Preview Upload
         * @description Draw channels as read by a mapping.
         */
        post: operations["preview_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/import": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Upload
         * @description Start importing the files with a mapping, completely or not at all.
         */
        post: operations["import_upload"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Modal Tables
         * @description List modal tables, in all versions.
         */
        get: operations["list_modal_tables"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/order": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Model Order
         * @description Reduce the predicted model at a condition, and return the number of modes needed.
         */
        get: operations["get_model_order"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Modal Table
         * @description Return one modal table with frequencies and damping, in the order of its source.
         */
        get: operations["get_modal_table"];
        put?: never;
        post?: never;
        /**
         * Delete Modal Table
         * @description Delete a modal table; refused if runs refer to it.
         */
        delete: operations["delete_modal_table"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Modes
         * @description List the modes at a fuel fraction, tracked over fuel by their shapes.
         */
        get: operations["list_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/shape": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Shape
         * @description Return one mode shape at a fuel fraction, on a thinned set of nodes, with the sensors.
         */
        get: operations["get_shape"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/correlation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Correlation
         * @description Correlate two modal tables: MAC pairs, frequency and damping differences, COMAC by point.
         */
        get: operations["get_correlation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/observability": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Observability
         * @description Return the observability of the modes by sensor, and the best further accelerometers.
         */
        get: operations["get_observability"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/file": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Download Modes
         * @description Return the modes at one fuel fraction as a universal file or CSV, in SI units.
         */
        get: operations["download_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/modal-tables/{modal_table_id}/corrections": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Correct Mode
         * @description Correct the name and symmetry of a mode, with a reason.
         */
        post: operations["correct_mode"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/structure": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Inspect Modal Files
         * @description Return the modes in the files of an upload, and the information missing for an import.
         */
        get: operations["inspect_modal_files"];
        put?: never;
        /**
         * Import Modal Data
         * @description Import the modes of uploaded files as a modal table, as a new version of its name.
         */
        post: operations["import_modal_data"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/flutter-summary": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Flutter Summary
         * @description Import the flutter summary of an uploaded printout, with its flutter speeds.
         */
        post: operations["import_flutter_summary"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter-summaries": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Flutter Summaries
         * @description List the flutter summaries of one aircraft, or of all.
         */
        get: operations["list_flutter_summaries"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter-summaries/{summary_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flutter Summary
         * @description Return one flutter summary.
         */
        get: operations["get_flutter_summary"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Responses
         * @description Import the frequency responses of uploaded files.
         */
        post: operations["import_responses"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Measured Responses
         * @description List the measured frequency responses of one aircraft, or of all.
         */
        get: operations["list_measured_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses/{responses_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Measured Responses
         * @description Return one set of measured frequency responses.
         */
        get: operations["get_measured_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/measured-responses/{responses_id}/modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Identify Modes
         * @description Identify modes from measured frequency responses; stable over the model order.
         */
        get: operations["identify_modes"];
        put?: never;
        /**
         * Save Identified Modes
         * @description Store identified modes as a GVT modal table, with the mode names of another table (MAC).
         */
        post: operations["save_identified_modes"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/uploads/{upload_id}/orthogonality": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Check Orthogonality
         * @description Check the orthogonality of mode shapes with a mass matrix of an uploaded file.
         */
        post: operations["check_orthogonality"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/predictions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Predictions
         * @description List predictions, of one aircraft or of all.
         */
        get: operations["list_predictions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/predictions/{prediction_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Prediction
         * @description Return one prediction with its derivatives at a fuel fraction.
         */
        get: operations["get_prediction"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Model Structures
         * @description List the newest versions of the model structures of one aircraft, or of all.
         */
        get: operations["list_model_structures"];
        put?: never;
        /**
         * Add Model Structure
         * @description Store a model structure under a name.
         */
        post: operations["add_model_structure"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Model Structure
         * @description Return the newest version of one model structure; its number is the ``ETag``.
         */
        get: operations["get_model_structure"];
        /**
         * Edit Model Structure
         * @description Store a new version; refused (409, with both versions) if the edited one is outdated.
         */
        put: operations["edit_model_structure"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Structure Versions
         * @description List every version of one model structure, oldest first.
         */
        get: operations["list_structure_versions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/versions/{version}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Structure Version
         * @description Return one version of one model structure.
         */
        get: operations["get_structure_version"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Decisions
         * @description List decisions, newest first.
         */
        get: operations["list_decisions"];
        put?: never;
        /**
         * Propose Decision
         * @description Propose a model structure, or a change of one, for a range of conditions.
         */
        post: operations["propose_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/audit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Campaign Audit
         * @description Return the audit trail of all decisions of a campaign.
         */
        get: operations["get_campaign_audit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Decision
         * @description Return one decision with its comments, votes and history.
         */
        get: operations["get_decision"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/revisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Revise Decision
         * @description Replace an open proposal; the votes are reset.
         */
        post: operations["revise_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/comments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Comment Decision
         * @description Comment on a decision, or on one derivative.
         */
        post: operations["comment_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/votes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Vote On Decision
         * @description Vote on a proposal: approve, reject or request changes; decided by the quorum.
         */
        post: operations["vote_on_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/withdrawal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Withdraw Decision
         * @description Withdraw a proposal; its author only.
         */
        post: operations["withdraw_decision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/audit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Decision Audit
         * @description Return the audit trail of one decision.
         */
        get: operations["get_decision_audit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/review-rules/{aircraft_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Review Rules
         * @description Return the review rules of a campaign, current and earlier ones.
         */
        get: operations["get_review_rules"];
        /**
         * Change Review Rules
         * @description Change the review rules of a campaign; earlier ones remain readable.
         */
        put: operations["change_review_rules"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/baselines": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Campaign Baselines
         * @description List the approved model structures of a campaign, most recently approved first.
         */
        get: operations["list_campaign_baselines"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/maneuver-baselines": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Maneuver Baselines
         * @description Return the approved model structure that runs of each maneuver use by default.
         */
        get: operations["list_maneuver_baselines"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/frozen-figures": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Freeze Figure
         * @description Store a figure in its current state, independent of later changes of the data.
         */
        post: operations["freeze_figure"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/frozen-figures/{figure_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Frozen Figure
         * @description Return kind, query, title and author of a frozen figure; `GET /figures/frozen` draws it.
         */
        get: operations["get_frozen_figure"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/notifications": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Notifications
         * @description Return the decisions awaiting an analyst, and the changes since their last visit.
         */
        get: operations["get_notifications"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/notifications/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Notifications Seen
         * @description Mark all notifications of an analyst as seen.
         */
        post: operations["mark_notifications_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/decisions/{decision_id}/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Decision Seen
         * @description Mark a decision as seen by an analyst.
         */
        post: operations["mark_decision_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/model-structures/{structure_id}/seen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Mark Structure Seen
         * @description Mark the newest version of a model structure as seen by an analyst.
         */
        post: operations["mark_structure_seen"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Runs
         * @description List runs with their key figures; `GET /runs/{run_id}` returns the details.
         */
        get: operations["list_runs"];
        put?: never;
        /**
         * Request Run
         * @description Queue an estimation run; ``Location`` is the address of its job.
         *
         *     Without a structure, the run uses the proposal of `GET /maneuvers/{maneuver_id}/run-proposal`:
         *     the structure approved for the condition, else the stored one of this FTA, else the modes in
         *     the excited band; the field `proposal` records which. Unknown modes, inputs and outputs are
         *     refused immediately. A request equal to a queued, running or succeeded run returns that run
         *     (200, ``repeated``).
         */
        post: operations["request_run"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/facets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Run Facets
         * @description Return the number of runs, in total and for each value of each filter.
         */
        get: operations["list_run_facets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/changes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Change Runs
         * @description Delete, restore, tag or untag many runs; all of them, or none.
         *
         *     The response lists the changed ids: the opposite action on them undoes the change.
         */
        post: operations["change_runs"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run
         * @description Return one run, with its parameters once it succeeded.
         */
        get: operations["get_run"];
        put?: never;
        post?: never;
        /**
         * Delete Run
         * @description Delete a run that has ended; it can be restored.
         */
        delete: operations["delete_run"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Export
         * @description Return the inputs and results of a run, with covariance matrix and fitted data points.
         */
        get: operations["get_run_export"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/runs/{run_id}/model": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Run Model
         * @description Return the identified model as state-space matrices with names and units.
         */
        get: operations["get_run_model"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/saved-views": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Saved Views
         * @description List saved views, of one page or of all.
         */
        get: operations["list_saved_views"];
        put?: never;
        /**
         * Add Saved View
         * @description Store the filters of a page under a name; refused if the name is in use.
         */
        post: operations["add_saved_view"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/saved-views/{view_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Delete Saved View
         * @description Delete a saved view.
         */
        delete: operations["delete_saved_view"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Searches
         * @description List searches, newest first.
         */
        get: operations["list_searches"];
        put?: never;
        /**
         * Request Search
         * @description Queue a model structure determination; ``Location`` is the address of the search.
         */
        post: operations["request_search"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Search
         * @description Return one search with its progress or result.
         */
        get: operations["get_search"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Search
         * @description Cancel a search that has not ended.
         */
        post: operations["cancel_search"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/searches/{search_id}/candidates/{place}/run": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Create Candidate Run
         * @description Return the run of a candidate; it is queued by the first request.
         */
        post: operations["create_candidate_run"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Jobs
         * @description List jobs, newest first.
         */
        get: operations["list_jobs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Queue Status
         * @description Return the state of the queue and its workers.
         */
        get: operations["get_queue_status"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Job
         * @description Return the progress of a job.
         */
        get: operations["get_job"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/log": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Job Log
         * @description Return the log of a job.
         */
        get: operations["get_job_log"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Job
         * @description Cancel a job that has not ended.
         */
        post: operations["cancel_job"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/jobs/{job_id}/retry": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Retry Job
         * @description Queue a failed or cancelled job again.
         */
        post: operations["retry_job"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Stream Events
         * @description Stream the state changes of runs, as server-sent events.
         *
         *     `run` is an entry of the run log, with its id; `running` lists the running jobs; `missed` means
         *     that events were dropped: reload the lists. Browsers resume after a reconnection (header
         *     `Last-Event-ID`); other clients give the id of the last known event.
         */
        get: operations["stream_events"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Batches
         * @description List batches with their progress, newest first.
         */
        get: operations["list_batches"];
        put?: never;
        /**
         * Request Batch
         * @description Queue many runs; all of them, or none.
         *
         *     Without structures, each run uses the proposed structure of its maneuver, as a single run does.
         */
        post: operations["request_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Batch
         * @description Return the progress of a batch.
         */
        get: operations["get_batch"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Batch
         * @description Cancel the unfinished runs of a batch; runs shared with another batch continue.
         */
        post: operations["cancel_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/batches/{batch_id}/retry": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Retry Batch
         * @description Queue the failed and cancelled runs of a batch again.
         */
        post: operations["retry_batch"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/comparisons": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Comparison
         * @description Compare derivatives of runs and predictions, with the difference of every pair.
         */
        get: operations["get_comparison"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/comparisons/trend": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Trend
         * @description Return one derivative over the flight conditions, with a weighted fit per method.
         */
        get: operations["get_trend"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/run/{run_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Run
         * @description Return the report of a run: structure, derivatives, fit, uncertainty, poles, provenance.
         */
        get: operations["report_run"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/comparison": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Comparison
         * @description Return the report of a comparison of runs and predictions, by derivative.
         */
        get: operations["report_comparison"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/decision/{decision_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Decision
         * @description Return the report of a decision: range, structure, evidence, votes and history.
         */
        get: operations["report_decision"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/reports/campaign": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Report Campaign
         * @description Return the report of the filtered maneuvers and their ground tests.
         */
        get: operations["report_campaign"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Designs
         * @description List excitation designs.
         */
        get: operations["list_designs"];
        put?: never;
        /**
         * Create Design
         * @description Create a design and optimise its phases; takes a few seconds.
         */
        post: operations["create_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/searches": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Start Design
         * @description Create a design and optimise its phases, as a task.
         */
        post: operations["start_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/flown": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Import Multisines
         * @description Import flown multisines: harmonics, amplitudes and phases are identified from the samples.
         */
        post: operations["import_multisines"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/catalogue": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Catalogue
         * @description List the 24 designs of Table 1.
         */
        get: operations["list_catalogue"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Design
         * @description Return one design.
         */
        get: operations["get_design"];
        put?: never;
        post?: never;
        /**
         * Delete Design
         * @description Delete a design.
         */
        delete: operations["delete_design"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/checks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Check Design
         * @description Check the orthogonality of the inputs, their peaks, and the response of an actuator.
         *
         *     Limits: position [rad], rate [rad/s], acceleration [rad/s2].
         */
        get: operations["check_design"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/target-modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Target Modes
         * @description Compare the band of a design with its target modes on an aircraft.
         */
        get: operations["get_target_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/expected-errors": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Predict Errors
         * @description Predict the standard errors of the derivatives of a run for this excitation (Cramér-Rao).
         */
        get: operations["predict_errors"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/expected-response": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Predict Response
         * @description Predict the signal-to-noise ratio of the modes and the correlation of the surfaces.
         */
        get: operations["predict_response"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/classic-inputs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Compare Classic Inputs
         * @description Compare a design with doublets, 3-2-1-1s and sweeps of equal limits; takes seconds.
         */
        get: operations["compare_classic_inputs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/amplitudes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Optimise Amplitudes
         * @description Optimise amplitudes: minimax relative standard error, and D-optimal.
         *
         *     Limits: largest deflection of any surface [rad] and load factor [g], feedback included;
         *     if omitted, those of the design.
         */
        get: operations["optimise_amplitudes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/rescaled": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Rescale Design
         * @description Store a design with the same harmonics and phases, and scaled amplitudes.
         */
        post: operations["rescale_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/redesign": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Redesign Phases
         * @description Optimise new phases for the harmonics of a design, such as an imported one, as a task.
         */
        post: operations["redesign_phases"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/preflight-simulations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Preflight Simulations
         * @description List the pre-flight simulations of a design, newest first, with their estimates.
         */
        get: operations["list_preflight_simulations"];
        put?: never;
        /**
         * Simulate Design
         * @description Simulate the flight of a design, as a task; stores the maneuver and queues its estimation.
         */
        post: operations["simulate_design"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/designs/{design_id}/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Export Design
         * @description Return one period at the rate of the flight computer, or the definition as JSON.
         */
        get: operations["export_design"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Controllers
         * @description List controllers, of one aircraft or all.
         */
        get: operations["list_controllers"];
        put?: never;
        /**
         * Create Controller
         * @description Store a controller given as text.
         */
        post: operations["create_controller"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers/files": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Upload Controller
         * @description Store a controller from a file.
         */
        post: operations["upload_controller"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/controllers/{controller_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Controller
         * @description Return one controller.
         */
        get: operations["get_controller"];
        put?: never;
        post?: never;
        /**
         * Delete Controller
         * @description Delete a controller that no pre-flight simulation used.
         */
        delete: operations["delete_controller"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter/results": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Start Flutter Prediction
         * @description Start the flutter prediction and its figures as a task; the results are cached.
         */
        post: operations["start_flutter_prediction"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/flutter": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Flutter
         * @description Return the predicted flutter speed of these runs, with its confidence interval.
         */
        get: operations["get_flutter"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/closed-loop/results": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Start Closed Loop Analysis
         * @description Start the closed-loop analysis as a task; its result is cached.
         */
        post: operations["start_closed_loop_analysis"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/closed-loop": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Closed Loop
         * @description Return the stability limit and margins of the identified aircraft with a controller.
         */
        get: operations["get_closed_loop"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Tasks
         * @description List current and recently ended tasks other than runs, newest first.
         */
        get: operations["list_tasks"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks/{task_id}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Get Task
         * @description Return the progress of a task.
         */
        get: operations["get_task"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/tasks/{task_id}/cancel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Cancel Task
         * @description Cancel a task; its results are discarded.
         */
        post: operations["cancel_task"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/envelope": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Envelope
         * @description Draw the flight conditions of the filtered maneuvers.
         */
        get: operations["draw_envelope"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/time-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Time History
         * @description Draw channels over time, decimated for the screen; by default the inputs.
         *
         *     CSV and MAT files contain every sample of the window.
         */
        get: operations["draw_time_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flight-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flight History
         * @description Draw channels of a whole flight over time; by default the commands.
         */
        get: operations["draw_flight_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/spectrum": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Spectrum
         * @description Draw Fourier magnitudes at the harmonics, coloured by input; by default of the inputs.
         */
        get: operations["draw_spectrum"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/signal-to-noise": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Signal To Noise
         * @description Draw the signal-to-noise ratio by channel and harmonic; by default of inputs and outputs.
         */
        get: operations["draw_signal_to_noise"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/plot-matrix": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Plot Matrix
         * @description Draw a scatter plot matrix of channels with their correlation; by default of the inputs.
         */
        get: operations["draw_plot_matrix"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/bode": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Bode
         * @description Draw measured frequency responses and those of identified models.
         */
        get: operations["draw_bode"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/reconstruction": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Reconstruction
         * @description Draw reconstructed motion and coefficients with ±2 standard errors.
         *
         *     In the time domain by the smoother (Fig. 16a), in the frequency domain by least squares at each
         *     harmonic, with rank and condition number.
         */
        get: operations["draw_reconstruction"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/loops": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Loops
         * @description Draw the measured loop gain of each surface, with its stability margins.
         */
        get: operations["draw_loops"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/ground-test": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Ground Test
         * @description Draw mini-GVT spectra before and after a flight.
         */
        get: operations["draw_ground_test"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/fit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Fit
         * @description Draw the fitted model and the measured data points.
         */
        get: operations["draw_fit"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/residual": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Residual
         * @description Draw the residuals by output and frequency.
         */
        get: operations["draw_residual"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/parameter-correlation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Parameter Correlation
         * @description Draw the correlation matrix of the estimates.
         */
        get: operations["draw_parameter_correlation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/poles": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Poles
         * @description Draw the poles of identified models, and the in-vacuo modes of the first.
         */
        get: operations["draw_poles"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/iterations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Iterations
         * @description Draw the cost over the iterations.
         */
        get: operations["draw_iterations"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/time-check": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Time Check
         * @description Draw recorded outputs and the response of the identified model to the recorded inputs.
         */
        get: operations["draw_time_check"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/derivatives": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Derivatives
         * @description Draw derivatives by method and prediction with ±2 standard errors.
         */
        get: operations["draw_derivatives"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/forest": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Forest
         * @description Draw the estimates and predictions of one derivative, with their mean (forest plot).
         */
        get: operations["draw_forest"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/trend": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Trend
         * @description Draw one derivative over the flight conditions, with weighted fits.
         */
        get: operations["draw_trend"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/v-omega-zeta": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw V Omega Zeta
         * @description Draw frequency and damping of the identified roots with ±2 standard errors.
         */
        get: operations["draw_v_omega_zeta"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/root-locus": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Root Locus
         * @description Draw the identified roots in the s-plane.
         */
        get: operations["draw_root_locus"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/equivalent-modes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Equivalent Modes
         * @description Draw equivalent frequency and damping of every run over dynamic pressure (Eq. 25).
         */
        get: operations["draw_equivalent_modes"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flutter-forecast": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flutter Forecast
         * @description Draw the predicted flutter speed by run, and by classical flutter prediction methods.
         */
        get: operations["draw_flutter_forecast"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/flutter-map": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Flutter Map
         * @description Draw the flutter speed over fuel and altitude.
         */
        get: operations["draw_flutter_map"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/closed-loop-margins": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Closed Loop Margins
         * @description Draw the stability margins of the loop of every surface over airspeed.
         */
        get: operations["draw_closed_loop_margins"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/closed-loop-roots": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Closed Loop Roots
         * @description Draw the roots with and without the controller.
         */
        get: operations["draw_closed_loop_roots"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/search-path": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Search Path
         * @description Draw the criteria after every step of a search.
         */
        get: operations["draw_search_path"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/search-stability": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Search Stability
         * @description Draw the frequency of selection of each term in bootstrap samples.
         */
        get: operations["draw_search_stability"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-history": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design History
         * @description Draw one period of an excitation design.
         */
        get: operations["draw_design_history"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-spectrum": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Spectrum
         * @description Draw the amplitudes of the harmonics of an excitation design, by input.
         */
        get: operations["draw_design_spectrum"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-worth": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Information
         * @description Draw the information of each harmonic of a design on the parameters of a run.
         */
        get: operations["draw_design_information"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/design-signal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Design Signal
         * @description Draw the expected signal-to-noise ratio by output and harmonic of a design.
         */
        get: operations["draw_design_signal"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/frozen": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Frozen
         * @description Draw a frozen figure in its stored state.
         */
        get: operations["draw_frozen"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/modes-against-fuel": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Modes Against Fuel
         * @description Draw frequency and damping of the modes of a table over fuel, with crossings.
         */
        get: operations["draw_modes_against_fuel"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/mac": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Mac
         * @description Draw the MAC of the modes of a table with itself, another fuel fraction or another table.
         */
        get: operations["draw_mac"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/model-order": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Model Order
         * @description Draw derivatives over the number of retained modes, with a band of ±10 %.
         */
        get: operations["draw_model_order"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/reduced-responses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Reduced Responses
         * @description Draw one frequency response of full and reduced models, and with rigid-body sensors.
         */
        get: operations["draw_reduced_responses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/figures/stabilisation": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Draw Stabilisation
         * @description Draw the stabilisation diagram: poles by model order, and the mean measured response.
         */
        get: operations["draw_stabilisation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/nomenclature": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * List Nomenclature
         * @description List all quantities with unit and meaning, or those of the given names.
         */
        get: operations["list_nomenclature"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /**
         * Action
         * @description Bulk actions; each has an inverse.
         * @enum {string}
         */
        Action: "delete" | "restore" | "tag" | "untag";
        /**
         * Against
         * @description Independent variable of a trend.
         * @enum {string}
         */
        Against: "dynamic_pressure" | "airspeed_ratio" | "fuel" | "fta";
        /**
         * AgreementCount
         * @description How many of the derivatives that can be judged agree within 2 combined standard errors.
         *
         *     ``source`` is the key of the prediction that is judged against the runs; None of the runs
         *     judged among each other.
         */
        AgreementCount: {
            /** Source */
            source?: string | null;
            /**
             * N Judged
             * @default 0
             */
            n_judged: number;
            /**
             * N Consistent
             * @default 0
             */
            n_consistent: number;
        };
        /**
         * Aircraft
         * @description Everything about one airframe that does not change from maneuver to maneuver.
         */
        Aircraft: {
            /** Name */
            name: string;
            geometry: components["schemas"]["Geometry"];
            mass: components["schemas"]["MassTable"];
            /** Surfaces */
            surfaces: components["schemas"]["Surface"][];
            /** Sensors */
            sensors: components["schemas"]["Sensor"][];
            /**
             * Combinations
             * @default []
             */
            combinations: components["schemas"]["Combination"][];
            /** Instruments */
            instruments: {
                [key: string]: components["schemas"]["Instrument"];
            };
            polar?: components["schemas"]["DragPolar"] | null;
            flutter?: components["schemas"]["FlutterTable"] | null;
            thrust?: components["schemas"]["ThrustTable"] | null;
            /**
             * Description
             * @default
             */
            description: string;
            /** Id */
            id?: number | null;
        };
        /**
         * AircraftList
         * @description Aircraft.
         */
        AircraftList: {
            /** Items */
            items: components["schemas"]["Aircraft"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Algorithm
         * @description How equation error chooses.
         * @enum {string}
         */
        Algorithm: "stepwise" | "orthogonal functions";
        /**
         * Along
         * @description Parameter of a root locus.
         * @enum {string}
         */
        Along: "airspeed" | "dynamic_pressure" | "fuel";
        /**
         * AssessRequest
         * @description Maneuvers whose data quality is assessed; all unassessed ones if omitted.
         */
        AssessRequest: {
            /** Maneuver Ids */
            maneuver_ids?: number[] | null;
        };
        /**
         * Assessing
         * @description Progress of the assessment of a campaign.
         */
        Assessing: {
            /** Running */
            running: boolean;
            /** Done */
            done: number;
            /** Total */
            total: number;
            /** Failed */
            failed: number;
        };
        /**
         * AuditTrail
         * @description Decisions of a campaign with its rules and baselines, as they stood at ``exported_at``.
         */
        AuditTrail: {
            aircraft: components["schemas"]["Aircraft"];
            /**
             * Exported At
             * Format: date-time
             */
            exported_at: string;
            /** Software */
            software: {
                [key: string]: string;
            };
            /** Check */
            check: string;
            /** Rules */
            rules: components["schemas"]["ReviewRules"][];
            /** Baselines */
            baselines: components["schemas"]["Baseline"][];
            /** Decisions */
            decisions: components["schemas"]["AuditedDecision"][];
        };
        /**
         * AuditedDecision
         * @description A decision with its events and linked records.
         *
         *     ``whole`` is true if no event was changed or removed and the events reproduce the state of
         *     the decision; ``changed_since`` lists evidence changed or deleted since the last event.
         */
        AuditedDecision: {
            decision: components["schemas"]["Decision"];
            /** Events */
            events: components["schemas"]["DecisionEvent"][];
            /** Whole */
            whole: boolean;
            /** Changed Since */
            changed_since: string[];
            /** Structures */
            structures: components["schemas"]["StructureVersion"][];
            /** Runs */
            runs: components["schemas"]["AuditedRun"][];
            /** Figures */
            figures: components["schemas"]["AuditedFigure"][];
        };
        /**
         * AuditedFigure
         * @description A frozen figure with its content.
         */
        AuditedFigure: {
            figure: components["schemas"]["FrozenFigure"];
            /** Spec */
            spec: {
                [key: string]: unknown;
            };
        };
        /**
         * AuditedRun
         * @description Summary of a linked run.
         */
        AuditedRun: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            /** Method */
            method: string;
            /** Author */
            author: string;
            /** Created At */
            created_at: string | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Outcome */
            outcome: string | null;
            /** R Squared */
            r_squared: {
                [key: string]: number;
            };
            /** Parameters */
            parameters: components["schemas"]["ParameterEstimate"][];
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
        };
        /**
         * Average
         * @description A condition channel over the maneuver; ``drift`` is its trend from start to end.
         */
        Average: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            /** Mean */
            mean: number;
            /** Std */
            std: number;
            /** Smallest */
            smallest: number;
            /** Largest */
            largest: number;
            /** Drift */
            drift: number;
        };
        /**
         * BandRequest
         * @description One input by its band: ``count`` harmonics, half of them near ``targets_hz`` if given.
         *
         *     ``spectrum`` gives relative power at frequencies [Hz], interpolated log-log; flat if omitted.
         */
        BandRequest: {
            /** Name */
            name: string;
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** Count */
            count: number;
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /**
             * Targets Hz
             * @default []
             */
            targets_hz: number[];
            /**
             * Spectrum
             * @default []
             */
            spectrum: [
                number,
                number
            ][];
        };
        /**
         * Baseline
         * @description An approved model structure, its decision and its range of conditions.
         */
        Baseline: {
            /** Decision Id */
            decision_id: number;
            /** Title */
            title: string;
            /** Limits */
            limits: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Approved By */
            approved_by: string[];
            structure: components["schemas"]["StructureVersion"];
        };
        /**
         * BaselineList
         * @description Baselines of a campaign, most recently approved first.
         */
        BaselineList: {
            /** Items */
            items: components["schemas"]["Baseline"][];
        };
        /**
         * Batch
         * @description Runs requested together.
         */
        Batch: {
            /** Name */
            name: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * BatchList
         * @description A page of batches.
         */
        BatchList: {
            /** Items */
            items: components["schemas"]["BatchProgress"][];
            /** Next */
            next: string | null;
        };
        /**
         * BatchProgress
         * @description Progress of a batch.
         */
        BatchProgress: {
            batch: components["schemas"]["Batch"];
            /** States */
            states: {
                [key: string]: number;
            };
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
        };
        /**
         * BatchRequest
         * @description Estimate many maneuvers by each of the methods, with each of the structures.
         *
         *     With ``from_equation_error``, OE and FRE runs wait for the EE run of the same maneuver and
         *     structure, and use its estimates as starting values.
         */
        BatchRequest: {
            /** Name */
            name: string;
            /** Maneuver Ids */
            maneuver_ids: number[];
            /** Methods */
            methods: components["schemas"]["Method"][];
            /**
             * Structures
             * @default []
             */
            structures: components["schemas"]["BatchStructure"][];
            settings?: components["schemas"]["SettingsRequest"] | null;
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /**
             * From Equation Error
             * @default false
             */
            from_equation_error: boolean;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            limits?: components["schemas"]["LimitsRequest"] | null;
        };
        /**
         * BatchStructure
         * @description A model structure of a batch: in full, or by id, in its newest version if none is given.
         */
        BatchStructure: {
            structure?: components["schemas"]["StructureRequest"] | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
        };
        /** Body_import_multisines */
        Body_import_multisines: {
            /**
             * Files
             * @description Samples of exactly one period.
             */
            files: string[];
            /** Name */
            name: string;
            /** Rate Hz */
            rate_hz: number;
            /**
             * Unit
             * @default deg
             * @enum {string}
             */
            unit: "deg" | "rad";
            /**
             * Separate
             * @description Each file is a separate design.
             * @default false
             */
            separate: boolean;
        };
        /** Body_upload_controller */
        Body_upload_controller: {
            /**
             * File
             * @description JSON, or MATLAB with A, B, C and D.
             */
            file: string;
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Reads
             * @description For MATLAB: measured signals, separated by commas.
             * @default
             */
            reads: string;
            /**
             * Drives
             * @description For MATLAB: driven surfaces, separated by commas.
             * @default
             */
            drives: string;
        };
        /** Body_upload_files */
        Body_upload_files: {
            /**
             * Files
             * @description Recorder files of one flight.
             */
            files: string[];
        };
        /** Body_upload_maneuver */
        Body_upload_maneuver: {
            /**
             * Files
             * @description Recorder files and tables.
             */
            files: string[];
            /**
             * Mapping
             * @description TOML with channels, units and roles; not needed for known formats.
             */
            mapping?: string | null;
            /**
             * Aircraft Id
             * @description If the mapping names no aircraft.
             */
            aircraft_id?: number | null;
            /**
             * Confirmed
             * @description The guesses of the mapping are confirmed.
             * @default false
             */
            confirmed: boolean;
        };
        /**
         * Butterworth
         * @description Analog low-pass filter of given order and corner. [rad/s]
         */
        Butterworth: {
            /** Order */
            order: number;
            /** Corner */
            corner: number;
        };
        /**
         * CatalogueList
         * @description Table 1.
         */
        CatalogueList: {
            /** Items */
            items: components["schemas"]["CatalogueRow"][];
            /** Next */
            next?: string | null;
        };
        /**
         * CatalogueRow
         * @description One row of Table 1; numbers of harmonics by input, ``periods``: duration in units of T.
         */
        CatalogueRow: {
            /** Number */
            number: number;
            /** Numbers */
            numbers: [
                number,
                number,
                number
            ];
            /** Axis */
            axis: string;
            /** Periods */
            periods: number;
            /** Surfaces */
            surfaces: number;
            /** Throttles */
            throttles: number;
            /** Harmonics Per Input */
            harmonics_per_input: number;
            /** Throttle Harmonics */
            throttle_harmonics: number;
            /** Targets */
            targets: string;
            /** Inputs */
            inputs: string[];
        };
        /**
         * Change
         * @description A change by another analyst; ``subject`` is a decision or a model structure.
         */
        Change: {
            /** Subject */
            subject: string;
            /** Id */
            id: number;
            /** Title */
            title: string;
            /** What */
            what: string;
            /** Author */
            author: string;
            /** Text */
            text: string;
            /** Number */
            number: number;
            /** At */
            at: string | null;
        };
        /**
         * ChangeRequest
         * @description One action on many maneuvers or runs; ``tag`` is used by ``tag`` and ``untag``.
         */
        ChangeRequest: {
            /** Ids */
            ids: number[];
            action: components["schemas"]["Action"];
            /** Tag */
            tag?: string | null;
        };
        /**
         * ChangedRecords
         * @description Ids of the records that an action changed.
         */
        ChangedRecords: {
            /** Ids */
            ids: number[];
        };
        /**
         * Channel
         * @description One recorded channel at its native rate, unit and precision.
         */
        Channel: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Array */
            array: string;
            /** Sensor */
            sensor?: string | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /** Source Field */
            source_field?: string | null;
            /** Maneuver Id */
            maneuver_id?: number | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ChannelQuality
         * @description Quality of one channel; None where undetermined.
         *
         *     ``signal_to_noise_db`` is the median over the harmonics, ``coherence`` that with the motion
         *     reconstructed from all other sensors, ``noise_excess`` the rms difference to it over its noise
         *     and one per cent of its level. ``not_checked`` is the reason why an output could not be checked
         *     against the others: nothing is concluded of its delay, scale factor and sign.
         *     ``delay_s`` counts from the reference, ``scale`` is recorded over true, ``bias`` in SI.
         *     At most fifty ``stretches`` are listed; ``n_stretches`` counts all.
         */
        ChannelQuality: {
            /** Name */
            name: string;
            /** Role */
            role: string;
            /** Unit */
            unit: string;
            /** Signal To Noise Db */
            signal_to_noise_db?: number | null;
            /** Coherence */
            coherence?: number | null;
            /** Noise Excess */
            noise_excess?: number | null;
            /** Delay S */
            delay_s?: number | null;
            /** Delay Std */
            delay_std?: number | null;
            /** Scale */
            scale?: number | null;
            /** Scale Std */
            scale_std?: number | null;
            /** Bias */
            bias?: number | null;
            /** Bias Std */
            bias_std?: number | null;
            /**
             * Bias Basis
             * @default
             */
            bias_basis: string;
            /**
             * Saturated
             * @default 0
             */
            saturated: number;
            /**
             * N Stretches
             * @default 0
             */
            n_stretches: number;
            /**
             * Stretches
             * @default []
             */
            stretches: components["schemas"]["FoundStretch"][];
            /** Not Checked */
            not_checked?: string | null;
        };
        /**
         * Checked
         * @description Channels of an upload by a mapping, with warnings on implausible units.
         *
         *     ``guesses`` are unconfirmed values; they prevent the import.
         *     ``rules`` are the ``[[channels]]`` of the mapping as written, for the table in the page.
         */
        Checked: {
            /** Rules */
            rules: {
                [key: string]: unknown;
            }[];
            /** Channels */
            channels: components["schemas"]["MappedChannel"][];
            /** Queries */
            queries: components["schemas"]["UnitWarning"][];
            /** Guesses */
            guesses: components["schemas"]["Guess"][];
            problem: components["schemas"]["MappingProblem"] | null;
        };
        /**
         * Choice
         * @description One choice of a filter, and the number of items that it selects with the other filters.
         */
        Choice: {
            /** Value */
            value: string;
            /** Label */
            label: string;
            /** Count */
            count: number;
        };
        /**
         * ClosedLoopStability
         * @description Airspeed at which the closed loop becomes unstable, and stability margins over airspeed.
         */
        ClosedLoopStability: {
            /** Sentence */
            sentence: string;
            /** Controller */
            controller: string;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Tested M S */
            tested_m_s: number;
            /** Lost M S */
            lost_m_s: number | null;
            /** Spread M S */
            spread_m_s: number;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
            /** Margins */
            margins: components["schemas"]["MarginRow"][];
        };
        /**
         * Combination
         * @description A channel made of others, e.g. ``az_ofs = 0.5 az_ofl + 0.5 az_ofr`` (Eq. 3).
         */
        Combination: {
            /** Name */
            name: string;
            /** Terms */
            terms: [
                string,
                number
            ][];
        };
        /**
         * CommentRequest
         * @description A comment on a decision, or on one derivative.
         */
        CommentRequest: {
            /** Text */
            text: string;
            /** Derivative */
            derivative?: string | null;
        };
        /**
         * ComparedInput
         * @description One kind of excitation: largest deflection [rad], load factor [g], energy [rad2 s].
         *
         *     ``pulse_s`` is the pulse length with the largest information; ``std_errors`` are empty where
         *     derivatives are not identifiable, and ``lacking`` is the reason.
         */
        ComparedInput: {
            /** Kind */
            kind: string;
            /** Pulse S */
            pulse_s: number | null;
            /** Deflection */
            deflection: number;
            /** Load Factor */
            load_factor: number;
            /** Energy */
            energy: number;
            /** Std Errors */
            std_errors: number[];
            /**
             * Lacking
             * @default
             */
            lacking: string;
        };
        /**
         * ComparedSource
         * @description One column of a comparison; ``kind`` is OE, FRE, EE or prediction.
         *
         *     ``changed_since`` names data of a run that were corrected after it was computed.
         */
        ComparedSource: {
            /** Key */
            key: string;
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** Run Id */
            run_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /**
             * Changed Since
             * @default []
             */
            changed_since: string[];
        };
        /**
         * Comparison
         * @description Rows per derivative, columns per source; the runs' verdict, and one per prediction.
         */
        Comparison: {
            /** Maneuver Ids */
            maneuver_ids: number[];
            /** Sources */
            sources: components["schemas"]["ComparedSource"][];
            /** Rows */
            rows: components["schemas"]["Row"][];
            /**
             * Pairs
             * @default []
             */
            pairs: components["schemas"]["Pair"][];
            /**
             * Setup
             * @default []
             */
            setup: components["schemas"]["Setup"][];
            /**
             * @default {
             *       "n_judged": 0,
             *       "n_consistent": 0
             *     }
             */
            runs_verdict: components["schemas"]["AgreementCount"];
            /**
             * Prediction Verdicts
             * @default []
             */
            prediction_verdicts: components["schemas"]["AgreementCount"][];
        };
        /**
         * ComparisonRequest
         * @description Runs and predictions to compare, for one coefficient or all.
         */
        ComparisonRequest: {
            /** Run Ids */
            run_ids: number[];
            /**
             * Prediction Ids
             * @default []
             */
            prediction_ids: number[];
            /** Coefficient */
            coefficient?: string | null;
        };
        /**
         * Condition
         * @description Flight condition averaged over the maneuver; origin of body axes is the c.g.
         */
        Condition: {
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Mass Kg */
            mass_kg: number;
            /** Pitch Inertia Kg M2 */
            pitch_inertia_kg_m2: number;
            /** X Cg M */
            x_cg_m: number;
            /** Z Cg M */
            z_cg_m: number;
            /**
             * Alpha Rad
             * @default 0
             */
            alpha_rad: number;
            /**
             * Gamma Rad
             * @default 0
             */
            gamma_rad: number;
            /**
             * Thrust N
             * @default 0
             */
            thrust_n: number;
            /** Flutter Speed M S */
            flutter_speed_m_s?: number | null;
        };
        /**
         * ConditioningList
         * @description Corrections of the channels of a maneuver.
         */
        ConditioningList: {
            /** Items */
            items: components["schemas"]["ConditioningStep"][];
        };
        /**
         * ConditioningRequest
         * @description Corrections to apply together.
         */
        ConditioningRequest: {
            /** Items */
            items: components["schemas"]["StepRequest"][];
        };
        /**
         * ConditioningStep
         * @description A correction that was taken; a step that is undone stays in the record.
         */
        ConditioningStep: {
            /** Maneuver Id */
            maneuver_id: number;
            correction: components["schemas"]["Correction"];
            /** Channel */
            channel: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Undone By */
            undone_by?: string | null;
            /** Undone At */
            undone_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ControlLaw
         * @description u = K y with the sign in K, in state-space form; SI and rad.
         */
        ControlLaw: {
            /** Airspeed M S */
            airspeed_m_s: number;
            /** A */
            A: number[][];
            /** B */
            B: number[][];
            /** C */
            C: number[][];
            /** D */
            D: number[][];
        };
        /**
         * Controller
         * @description A law reads outputs and drives surfaces by their names; linear between airspeeds.
         */
        Controller: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Reads */
            reads: string[];
            /** Drives */
            drives: string[];
            /** Laws */
            laws: components["schemas"]["ControlLaw"][];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ControllerList
         * @description Controllers, oldest first.
         */
        ControllerList: {
            /** Items */
            items: components["schemas"]["Controller"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ControllerRequest
         * @description A controller as JSON: ``reads``, ``drives``, and matrices or transfer functions.
         */
        ControllerRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Text */
            text: string;
        };
        /**
         * Correction
         * @description One correction of one channel; fields of other kinds have defaults.
         *
         *     ``stretches`` are the first sample and the sample after the last of each repair.
         *     ``std`` is the standard error of the delay [s] or of the scale factor [1].
         */
        Correction: {
            /** Channel */
            channel: string;
            kind: components["schemas"]["StepKind"];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Scale
             * @default 1
             */
            scale: number;
            /**
             * Bias
             * @default 0
             */
            bias: number;
            /**
             * Stretches
             * @default []
             */
            stretches: [
                number,
                number
            ][];
            /** Std */
            std?: number | null;
            /**
             * Basis
             * @default
             */
            basis: string;
        };
        /**
         * CorrectionRequest
         * @description A corrected name and symmetry of a mode, with the reason.
         */
        CorrectionRequest: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
        };
        /**
         * Correlation
         * @description Two sources of modes compared at their common points.
         */
        Correlation: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Other Id */
            other_id: number;
            /** Fuel */
            fuel: number;
            /** Other Fuel */
            other_fuel: number;
            /** N Points */
            n_points: number;
            /** Pairs */
            pairs: components["schemas"]["PairedMode"][];
            /** Points */
            points: components["schemas"]["PointAgreement"][];
            /** Notes */
            notes: string[];
        };
        /**
         * CutRequest
         * @description A window of a flight to cut out as a maneuver. [s]
         */
        CutRequest: {
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Stop S */
            stop_s: number;
            /** Fta */
            fta?: number | null;
            /** Axis */
            axis?: ("longitudinal" | "lateral") | null;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * Decision
         * @description Where a decision stands after its events; ``version`` counts them.
         *
         *     ``authors`` have made a revision of the proposal; ``votes`` are those that stand
         *     on the newest one.
         */
        Decision: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * DecisionDetail
         * @description A decision with its events, rules, proposed model structure and figures.
         *
         *     ``newest_version`` is the newest version of the proposed structure.
         */
        DecisionDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
            rules: components["schemas"]["ReviewRules"];
            /** Events */
            events: components["schemas"]["DecisionEvent"][];
            structure: components["schemas"]["StructureVersion"];
            /** Newest Version */
            newest_version: number;
            changes: components["schemas"]["StructureVersion"] | null;
            /** Figures */
            figures: components["schemas"]["FrozenFigure"][];
        };
        /**
         * DecisionEvent
         * @description One entry of the record of a decision; written once and never changed.
         *
         *     ``author`` is the name that was set, which nobody verified. ``data`` names all
         *     that the event rests on by hash, ``data_hash`` is the hash of that. ``sealed`` is the
         *     event as JSON, ``previous_hash`` included, and ``hash`` the SHA-256 of that text, so
         *     that no entry can be changed or taken out unnoticed.
         */
        DecisionEvent: {
            /** Decision Id */
            decision_id: number;
            /** Number */
            number: number;
            kind: components["schemas"]["EventKind"];
            /** Author */
            author: string;
            /**
             * Author Verified
             * @default false
             */
            author_verified: boolean;
            /** Text */
            text: string;
            /** Revision */
            revision: number;
            /** Derivative */
            derivative?: string | null;
            vote?: components["schemas"]["Vote"] | null;
            proposal?: components["schemas"]["StructureProposal"] | null;
            rules?: components["schemas"]["ReviewRules"] | null;
            /** By Decision Id */
            by_decision_id?: number | null;
            /** Data */
            data: {
                [key: string]: string;
            };
            /** Data Hash */
            data_hash: string;
            /** Software */
            software: {
                [key: string]: string;
            };
            /** Previous Hash */
            previous_hash: string;
            /**
             * Sealed
             * @default
             */
            sealed: string;
            /**
             * Hash
             * @default
             */
            hash: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * DecisionItem
         * @description A decision with the name of the proposed model structure.
         */
        DecisionItem: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Axis */
            axis: string;
            proposal: components["schemas"]["StructureProposal"];
            state: components["schemas"]["DecisionState"];
            /** Revision */
            revision: number;
            /** Authors */
            authors: string[];
            /** Votes */
            votes?: {
                [key: string]: components["schemas"]["Vote"];
            };
            /** Superseded By */
            superseded_by?: number | null;
            /** Version */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Adopted At */
            adopted_at?: string | null;
            /** Id */
            id?: number | null;
            /** Structure Name */
            structure_name: string;
        };
        /**
         * DecisionList
         * @description Decisions, newest first.
         */
        DecisionList: {
            /** Items */
            items: components["schemas"]["DecisionItem"][];
        };
        /**
         * DecisionState
         * @description Where a decision stands; the first two can still be voted on.
         * @enum {string}
         */
        DecisionState: "open" | "changes-requested" | "approved" | "rejected" | "withdrawn" | "superseded";
        /**
         * DerivativePrediction
         * @description Derivatives by name against fuel; ``values`` is the hash of a (F, len(names)) array.
         */
        DerivativePrediction: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Source */
            source: string;
            /** Kind */
            kind: string;
            /** Fuel */
            fuel: number[];
            /** Names */
            names: string[];
            /** Values */
            values: string;
            /** Std Errors */
            std_errors?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Id */
            id?: number | null;
        };
        /**
         * DerivativeTrend
         * @description One derivative over the conditions that were flown; ``unit`` is that of its values.
         */
        DerivativeTrend: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Unit */
            unit: string;
            against: components["schemas"]["Against"];
            /** Points */
            points: components["schemas"]["TrendPoint"][];
            /** Lines */
            lines: components["schemas"]["TrendLine"][];
        };
        /**
         * DerivativeValue
         * @description One predicted derivative.
         */
        DerivativeValue: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
        };
        /**
         * DesignChecks
         * @description ``correlation`` is the largest between two inputs over one period.
         */
        DesignChecks: {
            /** Correlation */
            correlation: number;
            /** Inputs */
            inputs: components["schemas"]["InputCheck"][];
        };
        /**
         * DesignList
         * @description Designs, oldest first.
         */
        DesignList: {
            /** Items */
            items: components["schemas"]["ExcitationDesign"][];
            /** Next */
            next?: string | null;
        };
        /**
         * DesignRequest
         * @description A row of Table 1 by ``fta``, or ``inputs`` by their harmonics, or ``bands``.
         *
         *     ``peaks`` are the low, medium and high amplitudes of an input with relative peak 1 [rad], at
         *     most 60 deg. With ``aircraft_id`` the band of a row includes its target modes on that aircraft.
         */
        DesignRequest: {
            /** Name */
            name: string;
            /** Duration S */
            duration_s: number;
            /** Rate Hz */
            rate_hz: number;
            /** Peaks */
            peaks: [
                number,
                number,
                number
            ];
            /** Fta */
            fta?: number | null;
            /** Aircraft Id */
            aircraft_id?: number | null;
            /**
             * First Harmonic
             * @default 1
             */
            first_harmonic: number;
            /**
             * Inputs
             * @default []
             */
            inputs: components["schemas"]["InputRequest"][];
            /**
             * Bands
             * @default []
             */
            bands: components["schemas"]["BandRequest"][];
            /**
             * Effort
             * @default thorough
             * @enum {string}
             */
            effort: "quick" | "thorough" | "patient";
            /**
             * Seed
             * @default 0
             */
            seed: number;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * DesignSpecification
         * @description Specification of a design; with the phases it is the complete recipe.
         *
         *     ``peaks`` are the largest deflections of an input with relative peak 1 at the
         *     three amplitudes, low to high, in the unit of the command.
         */
        DesignSpecification: {
            /** Duration S */
            duration_s: number;
            /** Rate Hz */
            rate_hz: number;
            /** Inputs */
            inputs: components["schemas"]["InputSpecification"][];
            /** Peaks */
            peaks: [
                number,
                number,
                number
            ];
            /**
             * Effort
             * @default thorough
             */
            effort: string;
            /**
             * Seed
             * @default 0
             */
            seed: number;
        };
        /**
         * DragPolar
         * @description Parabolic polar, for trim angle of attack and thrust without record or table.
         */
        DragPolar: {
            /** Cd Min */
            cd_min: number;
            /** Oswald */
            oswald: number;
            /** Aspect Ratio */
            aspect_ratio: number;
            /** Lift Slope */
            lift_slope: number;
        };
        /**
         * EquivalentLine
         * @description An in-vacuo mode from linear fits over dynamic pressure (Eq. 25).
         *
         *     ``table_hz`` is the frequency of the modal table; derivatives are C_Qi_eta_i and C_Qi_etadot_i.
         */
        EquivalentLine: {
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Table Hz */
            table_hz: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** Frequency Std Hz */
            frequency_std_hz: number;
            /** Damping */
            damping: number;
            /** Damping Std */
            damping_std: number;
            /** Stiffness Derivative */
            stiffness_derivative: number;
            /** Stiffness Derivative Std */
            stiffness_derivative_std: number;
            /** Damping Derivative */
            damping_derivative: number;
            /** Damping Derivative Std */
            damping_derivative_std: number;
        };
        /**
         * EquivalentPoint
         * @description A mode as if it stood alone in the air of one run (Eq. 25), at the loading asked for.
         *
         *     Frequency and damping are None where the air has taken all stiffness.
         */
        EquivalentPoint: {
            /** Run Id */
            run_id: number;
            /** Label */
            label: string;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number | null;
            /** Frequency Std Hz */
            frequency_std_hz: number | null;
            /** Damping */
            damping: number | null;
            /** Damping Std */
            damping_std: number | null;
        };
        /**
         * EstimationRun
         * @description A request and, once done, its result.
         *
         *     Of those that wait, the one with the highest ``priority`` starts first, and none
         *     before ``after_run_id`` has succeeded. ``data_hash`` names what was recorded and
         *     assumed, ``input_hash`` that and the request: equal inputs are one run.
         *     ``rests_on`` are the hashes of the records it was computed from (None: not recorded, by an
         *     earlier release). ``result_hash`` was stored with the result; ``altered`` is whether the
         *     result or the request was changed since. ``proposal`` is set if the model structure was
         *     proposed.
         */
        EstimationRun: {
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /** @default queued */
            state: components["schemas"]["RunState"];
            /**
             * Attempt
             * @default 0
             */
            attempt: number;
            progress?: components["schemas"]["Progress"] | null;
            /** Error */
            error?: {
                [key: string]: string;
            } | null;
            result?: components["schemas"]["RunResult"] | null;
            /** Versions */
            versions?: {
                [key: string]: string;
            } | null;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Started At */
            started_at?: string | null;
            /** Finished At */
            finished_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            /** After Run Id */
            after_run_id?: number | null;
            limits?: components["schemas"]["Limits"] | null;
            /** Data Hash */
            data_hash?: string | null;
            /** Input Hash */
            input_hash?: string | null;
            /** Worker */
            worker?: string | null;
            /** Rests On */
            rests_on?: {
                [key: string]: string;
            } | null;
            /** Result Hash */
            result_hash?: string | null;
            /**
             * Altered
             * @default false
             */
            altered: boolean;
            proposal?: components["schemas"]["ProposalBasis"] | null;
            /** Id */
            id?: number | null;
        };
        /**
         * EventKind
         * @description Kind of event of a decision.
         * @enum {string}
         */
        EventKind: "proposed" | "revised" | "commented" | "voted" | "withdrawn" | "adopted" | "declined" | "superseded" | "narrowed";
        /**
         * Excitation
         * @description Which harmonics of 1/period each input owns (the sets K_j of Eq. 4).
         */
        Excitation: {
            /** Period S */
            period_s: number;
            /** Harmonics */
            harmonics: {
                [key: string]: number[];
            };
            /**
             * Start S
             * @default 0
             */
            start_s: number;
            /**
             * N Periods
             * @default 1
             */
            n_periods: number;
        };
        /**
         * ExcitationDesign
         * @description A stored design; ``specification`` and ``phases`` [rad] together reproduce it.
         *
         *     ``fta`` is the lowest number of the design in Table 1, where it is one.
         */
        ExcitationDesign: {
            /** Name */
            name: string;
            specification: components["schemas"]["DesignSpecification"];
            /** Phases */
            phases: {
                [key: string]: number[];
            };
            /** Peak Factors */
            peak_factors: {
                [key: string]: number;
            };
            /** Fta */
            fta?: number | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ExpectedError
         * @description A derivative of a model and its predicted standard error under a design.
         */
        ExpectedError: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number;
        };
        /**
         * ExpectedErrors
         * @description Predicted standard errors under a design, with the assumptions of the prediction.
         *
         *     ``surfaces`` is the assumed response of surfaces to commands, and ``lines_outside`` the number
         *     of harmonics outside the run's band, where noise and responses are held constant.
         */
        ExpectedErrors: {
            /** Items */
            items: components["schemas"]["ExpectedError"][];
            /** Surfaces */
            surfaces: string;
            /** Lines Outside */
            lines_outside: number;
            /** Next */
            next?: string | null;
        };
        /**
         * ExpectedMode
         * @description How well a design shows a mode: the best output around its frequency.
         *
         *     ``lines`` are those within the mode's half-power band; ``signal_to_noise`` is the amplitude
         *     ratio of ``output`` there or at the nearest lines. Both are None where no line excites the
         *     mode. [Hz], [1], [1]
         */
        ExpectedMode: {
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Damping */
            damping: number;
            /** Lines */
            lines: number;
            /** Output */
            output: string | null;
            /** Signal To Noise */
            signal_to_noise: number | null;
        };
        /**
         * ExpectedSummary
         * @description Expected signal of the modes, correlation of the surface deflections, information by input.
         *
         *     ``worth`` is the information of the harmonics of each input, as a number of parameters.
         */
        ExpectedSummary: {
            /** Modes */
            modes: components["schemas"]["ExpectedMode"][];
            /** Surfaces */
            surfaces: string[];
            /** Correlation */
            correlation: number[][];
            /** Worth */
            worth: {
                [key: string]: number;
            };
        };
        /**
         * ExportedLines
         * @description Fitted spectra of one block; rows by frequency, columns by output.
         */
        ExportedLines: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
            /** Omega */
            omega: number[];
            /** Measured Real */
            measured_real: number[][];
            /** Measured Imag */
            measured_imag: number[][];
            /** Fitted Real */
            fitted_real: number[][];
            /** Fitted Imag */
            fitted_imag: number[][];
        };
        /**
         * Facets
         * @description Number of items that all filters select, and the choices of each filter by its name.
         */
        Facets: {
            /** Total */
            total: number;
            /** Choices */
            choices: {
                [key: string]: components["schemas"]["Choice"][];
            };
        };
        /**
         * FieldError
         * @description An error in one field of a request.
         */
        FieldError: {
            /** Field */
            field: string;
            /** Message */
            message: string;
        };
        /**
         * Figure
         * @description A Plotly figure; theme, fonts and height are set by the frontend.
         */
        Figure: {
            /** Data */
            data: {
                [key: string]: unknown;
            }[];
            /** Layout */
            layout: {
                [key: string]: unknown;
            };
        };
        /**
         * Figures
         * @description The numbers that a campaign is sorted by.
         */
        Figures: {
            /** Signal To Noise Db */
            signal_to_noise_db?: number | null;
            /** Largest Skew S */
            largest_skew_s?: number | null;
            /** Largest Skew Channel */
            largest_skew_channel?: string | null;
            /** Least Coherence */
            least_coherence?: number | null;
            /**
             * N Stretches
             * @default 0
             */
            n_stretches: number;
            /**
             * Saturated
             * @default 0
             */
            saturated: number;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Fuel Change */
            fuel_change?: number | null;
            /** Airspeed Drift */
            airspeed_drift?: number | null;
        };
        /**
         * FirstOrder
         * @description Lag with unit static gain: wc / (s + wc).
         */
        FirstOrder: {
            /** Corner */
            corner: number;
        };
        /**
         * Fit
         * @description How the maximisation ended and how well the model fits.
         */
        Fit: {
            /** Outcome */
            outcome: string;
            /** Message */
            message: string;
            /** Iterations */
            iterations: components["schemas"]["Iteration"][];
            /** Cost */
            cost: number | null;
            /** R Squared */
            r_squared: {
                [key: string]: number;
            };
            /** N Lines */
            n_lines: number;
            /** N Parameters */
            n_parameters: number;
            /** Seconds */
            seconds: number;
            /** Start */
            start: string;
            /**
             * Warnings
             * @default []
             */
            warnings: string[];
            /**
             * Quality
             * @default []
             */
            quality: components["schemas"]["OutputQuality"][];
        };
        /**
         * FitBlock
         * @description One set of fitted data: OE one, FRE one per input, EE one per coefficient.
         *
         *     ``arrays`` names hashes: ``omega`` (M,), ``measured`` and ``fitted`` (M, len(outputs)).
         */
        FitBlock: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
        };
        /**
         * FixedTo
         * @description A source by kind and id; a prediction is read at the fuel of the maneuver.
         */
        FixedTo: {
            source: components["schemas"]["HeldBy"];
            /** Id */
            id: number;
        };
        /**
         * FixedToRequest
         * @description Run or prediction whose value a derivative is fixed to.
         */
        FixedToRequest: {
            source: components["schemas"]["HeldBy"];
            /** Id */
            id: number;
        };
        /**
         * Flight
         * @description One flight; its maneuvers point back to it.
         */
        Flight: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Number */
            number: number;
            /** Flown On */
            flown_on?: string | null;
            /**
             * Description
             * @default
             */
            description: string;
            /** Id */
            id?: number | null;
        };
        /**
         * FlightChannel
         * @description One channel of a whole recording, from which maneuvers are cut.
         *
         *     Native rate, unit and precision; the field and file that it came from.
         */
        FlightChannel: {
            /** Flight Id */
            flight_id: number;
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Array */
            array: string;
            /** Sensor */
            sensor?: string | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /** Source Field */
            source_field?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * FlightChannelList
         * @description Channels of a whole flight.
         */
        FlightChannelList: {
            /** Items */
            items: components["schemas"]["FlightChannel"][];
        };
        /**
         * FlightConditionQuality
         * @description The flight condition with its spread, and whether one linear model holds over it.
         *
         *     ``separation_factor`` is the lowest structural over the highest rigid-body frequency of
         *     the predicted model: from five on, rigid and elastic motion may be taken apart.
         */
        FlightConditionQuality: {
            /** Averages */
            averages: components["schemas"]["Average"][];
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Fuel Change */
            fuel_change: number | null;
            /** Airspeed Drift */
            airspeed_drift: number | null;
            /** Separation Factor */
            separation_factor: number | null;
            /** Time Invariant */
            time_invariant: boolean | null;
        };
        /**
         * FlightList
         * @description Flights.
         */
        FlightList: {
            /** Items */
            items: components["schemas"]["Flight"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Flutter
         * @description Flutter prediction with the margin of the next test point; ``safe`` if it is stable.
         *
         *     ``airspeed_std_m_s`` is statistical, ``spread_m_s`` the standard deviation between model
         *     structures, ``modal_std_m_s`` that from the frequencies of the modal table; ``low_m_s`` to
         *     ``high_m_s`` holds the flutter speed with 95 % probability. ``margin`` is that of the fastest
         *     point flown, ``predicted_flutter_m_s`` the prediction of the aircraft's table before flight.
         *     ``refusal`` is the reason without a flutter speed: a model that flight contradicts, or an
         *     unstable root that the data do not determine; empty otherwise. The
         *     search was from ``searched_from_m_s`` to ``searched_to_m_s``.
         */
        Flutter: {
            /** Sentence */
            sentence: string;
            /** Refusal */
            refusal: string;
            /** Searched From M S */
            searched_from_m_s: number;
            /** Searched To M S */
            searched_to_m_s: number;
            /** Test Point Margin */
            test_point_margin: string;
            /** Safe */
            safe: boolean;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Density Kg M3 */
            density_kg_m3: number;
            /** Tested M S */
            tested_m_s: number;
            /** Margin */
            margin: number | null;
            /** Next M S */
            next_m_s: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Spread M S */
            spread_m_s: number;
            /** Modal Std M S */
            modal_std_m_s: number;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
            /** Frequency Rad S */
            frequency_rad_s: number | null;
            /** Mechanism */
            mechanism: string | null;
            /** Participation */
            participation: components["schemas"]["Participation"][];
            /** Predicted Flutter M S */
            predicted_flutter_m_s: number | null;
            /** Structures */
            structures: components["schemas"]["StructureForecast"][];
            /** Runs */
            runs: components["schemas"]["RunForecast"][];
            /** Progress */
            progress: components["schemas"]["ProgressForecast"][];
            /** Trackers */
            trackers: components["schemas"]["TrackerForecast"][];
            /** Equivalents */
            equivalents: components["schemas"]["EquivalentLine"][];
            /** Equivalent Points */
            equivalent_points: components["schemas"]["EquivalentPoint"][];
        };
        /**
         * FlutterPoint
         * @description Where a root of a flutter analysis loses its damping.
         *
         *     ``analysis`` names what it is of: subcase, symmetry, Mach number, density, method. Where
         *     ``is_bound``, the root was not seen stable at a lower speed: it goes unstable at or below
         *     ``airspeed_m_s``. ``density_ratio`` and ``mach`` are None where the file gives none.
         */
        FlutterPoint: {
            /** Root */
            root: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Omega Rad S */
            omega_rad_s: number;
            /** @default flutter */
            kind: components["schemas"]["Instability"];
            /**
             * Is Bound
             * @default false
             */
            is_bound: boolean;
            /**
             * Analysis
             * @default
             */
            analysis: string;
            /** Mach */
            mach?: number | null;
            /** Density Ratio */
            density_ratio?: number | null;
        };
        /**
         * FlutterSummary
         * @description Roots of a flutter analysis (Nastran SOL 145) against airspeed.
         *
         *     ``arrays`` names ``analysis`` (N,), ``root`` (N,), ``airspeed`` (N,) [m/s], ``damping``
         *     (N,) structural damping g [1], ``omega`` and ``growth`` (N,), imaginary and real part of the
         *     root [rad/s, 1/s], and, where printed, ``density`` and ``mach`` (N,). A root is one of its
         *     analysis only. ``notes`` name the analyses, and what no speed is read from.
         */
        FlutterSummary: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Points */
            points: components["schemas"]["FlutterPoint"][];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /**
             * Origin
             * @default
             */
            origin: string;
            /** Id */
            id?: number | null;
        };
        /**
         * FlutterSummaryList
         * @description Flutter summaries.
         */
        FlutterSummaryList: {
            /** Items */
            items: components["schemas"]["FlutterSummary"][];
            /** Next */
            next?: string | null;
        };
        /**
         * FlutterSummaryRequest
         * @description Name of a flutter summary, and unit of its velocities.
         */
        FlutterSummaryRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Speed Unit
             * @enum {string}
             */
            speed_unit: "m/s" | "ft/s" | "in/s" | "kt" | "km/h";
        };
        /**
         * FlutterTable
         * @description Predicted open-loop flutter speed against fuel; campaigns are planned in V/V_f.
         */
        FlutterTable: {
            /** Fuel */
            fuel: number[];
            /** Speed M S */
            speed_m_s: number[];
        };
        /**
         * FoundField
         * @description One column of a file: its rate, if the file has a time, and its first values.
         */
        FoundField: {
            /** File */
            file: string;
            /** Field */
            field: string;
            /** Unit */
            unit: string;
            /** N Samples */
            n_samples: number;
            /** Rate Hz */
            rate_hz: number | null;
            /** First */
            first: (number | null)[];
            /** Smallest */
            smallest: number | null;
            /** Largest */
            largest: number | null;
        };
        /**
         * FoundManeuver
         * @description A stretch of a flight that looks like a maneuver, with trim before and after.
         *
         *     ``basis`` is the source of the interval; ``maneuver_id`` an existing maneuver there.
         */
        FoundManeuver: {
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Stop S */
            stop_s: number;
            excitation: components["schemas"]["Excitation"] | null;
            /** N Periods */
            n_periods: number;
            /** Fta */
            fta: number | null;
            /** Basis */
            basis: string;
            /** Maneuver Id */
            maneuver_id?: number | null;
        };
        /**
         * FoundManeuverList
         * @description Maneuvers detected in the recording of a flight.
         */
        FoundManeuverList: {
            /** Items */
            items: components["schemas"]["FoundManeuver"][];
        };
        /**
         * FoundMode
         * @description A mode found in measured responses; the scatter is that over the model orders.
         */
        FoundMode: {
            /** Frequency Hz */
            frequency_hz: number;
            /** Std Hz */
            std_hz: number;
            /** Damping */
            damping: number;
            /** Std Damping */
            std_damping: number;
            /** N Orders */
            n_orders: number;
            /** Collinearity */
            collinearity: number;
        };
        /**
         * FoundModes
         * @description Modes found in measured responses; ``fit_error`` is relative, rms over all of them.
         */
        FoundModes: {
            /** Responses Id */
            responses_id: number;
            /** Fit Error */
            fit_error: number;
            /** Scaled */
            scaled: boolean;
            /** Items */
            items: components["schemas"]["FoundMode"][];
        };
        /**
         * FoundStretch
         * @description Samples that are a spike, a dropout or saturated, and when they begin. [s]
         */
        FoundStretch: {
            /** Kind */
            kind: string;
            /** First */
            first: number;
            /** Stop */
            stop: number;
            /** Start S */
            start_s: number;
        };
        /**
         * FreezeRequest
         * @description A figure of ``GET /figures/{kind}?{query}``, to be stored in its current state.
         */
        FreezeRequest: {
            /** Kind */
            kind: string;
            /** Query */
            query: string;
            /** Title */
            title: string;
        };
        /**
         * FrozenFigure
         * @description A figure frozen as evidence; ``array`` is its JSON.
         */
        FrozenFigure: {
            /** Kind */
            kind: string;
            /** Query */
            query: string;
            /** Title */
            title: string;
            /** Array */
            array: string;
            /** Author */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * Geometry
         * @description Reference dimensions of the wing.
         */
        Geometry: {
            /** Area M2 */
            area_m2: number;
            /** Chord M */
            chord_m: number;
            /** Span M */
            span_m: number;
        };
        /**
         * Glossary
         * @description All quantities.
         */
        Glossary: {
            /** Items */
            items: components["schemas"]["GlossaryEntry"][];
            /** Next */
            next?: string | null;
        };
        /**
         * GlossaryEntry
         * @description One quantity of the glossary, with the stored unit and the displayed unit.
         */
        GlossaryEntry: {
            /** Symbol */
            symbol: string;
            /** Unit */
            unit: string;
            /** Display Unit */
            display_unit: string;
            /** Label */
            label: string;
            /** Meaning */
            meaning: string;
        };
        /**
         * GroundTest
         * @description Pre-flight and post-flight record of one flight, compared.
         */
        GroundTest: {
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Before Id */
            before_id: number;
            /** After Id */
            after_id: number;
            /** Fuel Before */
            fuel_before: number;
            /** Fuel After */
            fuel_after: number;
            /** Peaks */
            peaks: components["schemas"]["PeakChange"][];
            verdict: components["schemas"]["GroundTestVerdict"];
            /** Message */
            message: string;
        };
        /**
         * GroundTestList
         * @description Ground tests of all flights that have one.
         */
        GroundTestList: {
            /** Items */
            items: components["schemas"]["GroundTest"][];
        };
        /**
         * GroundTestVerdict
         * @description Result of a pair of ground records.
         * @enum {string}
         */
        GroundTestVerdict: "healthy" | "watch" | "alarm";
        /**
         * Guess
         * @description An unconfirmed value with its key and consequence.
         */
        Guess: {
            kind: components["schemas"]["GuessKind"];
            /** Key */
            key: string;
            /** Value */
            value: string;
            /** Consequence */
            consequence: string;
        };
        /**
         * GuessKind
         * @description Kind of an unconfirmed value.
         * @enum {string}
         */
        GuessKind: "aircraft" | "flight" | "clock" | "unit" | "role" | "condition";
        /**
         * Health
         * @description State of the service and its parts: database, dispatcher, workers, clock.
         *
         *     ``status`` is ok, or degraded if any part is.
         */
        Health: {
            status: components["schemas"]["PartState"];
            /** Version */
            version: string;
            /** Database */
            database: string;
            /** Migration */
            migration: string;
            /** Parts */
            parts: components["schemas"]["PartHealth"][];
        };
        /**
         * HeldBy
         * @description Kind of source whose value a derivative is held at.
         * @enum {string}
         */
        HeldBy: "prediction" | "run";
        /**
         * IdentifiedModesRequest
         * @description Identified modes to store, and the name of their modal table.
         */
        IdentifiedModesRequest: {
            /** Name */
            name: string;
            /** Low Hz */
            low_hz?: number | null;
            /** High Hz */
            high_hz?: number | null;
            /**
             * Order
             * @default 30
             */
            order: number;
            /** Selected */
            selected?: number[] | null;
            /** Template Id */
            template_id?: number | null;
        };
        /**
         * InputCheck
         * @description One input: command and true deflection at their largest. [unit], [unit/s], [unit/s2]
         */
        InputCheck: {
            /** Name */
            name: string;
            /** Peak Factor */
            peak_factor: number;
            /** Command Peak */
            command_peak: number;
            /** Start */
            start: number;
            /** Deflection Peak */
            deflection_peak: number;
            /** Rate Peak */
            rate_peak: number;
            /** Acceleration Peak */
            acceleration_peak: number;
            /** Within Limits */
            within_limits: boolean;
        };
        /**
         * InputComparison
         * @description Multisine first, then classic inputs; standard errors in the order of ``names``.
         */
        InputComparison: {
            /** Names */
            names: string[];
            /** Values */
            values: number[];
            /** Inputs */
            inputs: components["schemas"]["ComparedInput"][];
            /** Next */
            next?: string | null;
        };
        /**
         * InputPair
         * @description Correlation of two inputs while the excitation ran.
         */
        InputPair: {
            /** First */
            first: string;
            /** Second */
            second: string;
            /** Correlation */
            correlation: number;
        };
        /**
         * InputRequest
         * @description One input with its harmonics; relative ``power`` by harmonic, flat if omitted.
         */
        InputRequest: {
            /** Name */
            name: string;
            /** Harmonics */
            harmonics: number[];
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /** Power */
            power?: number[] | null;
        };
        /**
         * InputSpecification
         * @description One input: its harmonics, its peak relative to the design's, and the power of each harmonic.
         *
         *     ``power`` is relative; the spectrum is flat by default.
         */
        InputSpecification: {
            /** Name */
            name: string;
            /** Harmonics */
            harmonics: number[];
            /**
             * Relative Peak
             * @default 1
             */
            relative_peak: number;
            /** Power */
            power?: number[] | null;
        };
        /**
         * Instability
         * @description How a root of a flutter analysis goes unstable.
         * @enum {string}
         */
        Instability: "flutter" | "divergence";
        /**
         * Instrument
         * @description A chain of elements followed by a pure delay. [s]
         */
        Instrument: {
            /**
             * Elements
             * @default []
             */
            elements: (components["schemas"]["SecondOrder"] | components["schemas"]["FirstOrder"] | components["schemas"]["Butterworth"])[];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
        };
        /**
         * Iteration
         * @description One step of the maximisation; the first one of a stage is where it starts.
         *
         *     Stages after the first fit lines that were corrected anew for the ends of the record: costs
         *     of different stages are of different data and cannot be compared.
         */
        Iteration: {
            /** Iteration */
            iteration: number;
            /** Cost */
            cost: number;
            /** Step */
            step: number;
            /**
             * Stage
             * @default 0
             */
            stage: number;
        };
        /**
         * Job
         * @description Progress of a run; a job has the id of its run.
         */
        Job: {
            /** Id */
            id: number;
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            /** Attempt */
            attempt: number;
            /** Priority */
            priority: number;
            /** After Run Id */
            after_run_id: number | null;
            progress: components["schemas"]["Progress"] | null;
            error: components["schemas"]["JobError"] | null;
            /** Worker */
            worker: string | null;
            /** Author */
            author: string;
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
        };
        /**
         * JobError
         * @description Why a run failed.
         */
        JobError: {
            /** Code */
            code: string;
            /** Message */
            message: string;
        };
        /**
         * JobList
         * @description A page of jobs.
         */
        JobList: {
            /** Items */
            items: components["schemas"]["Job"][];
            /** Next */
            next: string | null;
        };
        /**
         * JobLog
         * @description The log of a job, oldest entry first.
         */
        JobLog: {
            /** Items */
            items: components["schemas"]["RunEvent"][];
        };
        /**
         * LatestRun
         * @description The newest run of one method.
         */
        LatestRun: {
            /** Id */
            id: number;
            state: components["schemas"]["RunState"];
        };
        /**
         * LimitedQuantity
         * @description Quantity of a range of conditions.
         * @enum {string}
         */
        LimitedQuantity: "dynamic_pressure_pa" | "fuel_fraction" | "airspeed_m_s" | "airspeed_ratio" | "alpha_rad";
        /**
         * Limits
         * @description Limits of a run; None for those of the server.
         */
        Limits: {
            /** Time S */
            time_s?: number | null;
            /** Memory Mb */
            memory_mb?: number | null;
        };
        /**
         * LimitsRequest
         * @description Time and memory limits of a run; it is stopped beyond them.
         */
        LimitsRequest: {
            /** Time S */
            time_s?: number | null;
            /** Memory Mb */
            memory_mb?: number | null;
        };
        /**
         * LinkedComparison
         * @description Runs and predictions that were compared; ``coefficient`` where only one was.
         */
        LinkedComparison: {
            /** Run Ids */
            run_ids: number[];
            /**
             * Prediction Ids
             * @default []
             */
            prediction_ids: number[];
            /** Coefficient */
            coefficient?: string | null;
        };
        /**
         * Maneuver
         * @description One research maneuver: its interval, excitation and condition.
         */
        Maneuver: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Flight Id */
            flight_id: number;
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Duration S */
            duration_s: number;
            condition: components["schemas"]["Condition"];
            /** Fta */
            fta?: number | null;
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            excitation?: components["schemas"]["Excitation"] | null;
            /** Airspeed Ratio */
            airspeed_ratio?: number | null;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ManeuverBaseline
         * @description The baseline of a maneuver; none if no structure was approved for its condition.
         */
        ManeuverBaseline: {
            /** Maneuver Id */
            maneuver_id: number;
            baseline: components["schemas"]["Baseline"] | null;
        };
        /**
         * ManeuverBaselineList
         * @description Baselines of maneuvers, in the order of the request.
         */
        ManeuverBaselineList: {
            /** Items */
            items: components["schemas"]["ManeuverBaseline"][];
        };
        /**
         * ManeuverDetail
         * @description A maneuver with its flight number, aircraft, channels and tags.
         */
        ManeuverDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Flight Id */
            flight_id: number;
            /** Label */
            label: string;
            /** Start S */
            start_s: number;
            /** Duration S */
            duration_s: number;
            condition: components["schemas"]["Condition"];
            /** Fta */
            fta?: number | null;
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            excitation?: components["schemas"]["Excitation"] | null;
            /** Airspeed Ratio */
            airspeed_ratio?: number | null;
            /** Max Input Correlation */
            max_input_correlation?: number | null;
            /** Source File */
            source_file?: string | null;
            /** Source Hash */
            source_hash?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Deleted At */
            deleted_at?: string | null;
            /** Id */
            id?: number | null;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Channels */
            channels: components["schemas"]["Channel"][];
            /** Tags */
            tags: string[];
        };
        /**
         * ManeuverItem
         * @description One item of the list.
         */
        ManeuverItem: {
            /** Id */
            id: number;
            /** Label */
            label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Axis */
            axis: string;
            /** Duration S */
            duration_s: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Max Input Correlation */
            max_input_correlation: number | null;
            /** N Runs */
            n_runs: number;
            /** Runs */
            runs: {
                [key: string]: components["schemas"]["LatestRun"] | null;
            };
            /** Tags */
            tags: string[];
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Deleted At */
            deleted_at: string | null;
        };
        /**
         * ManeuverList
         * @description A page of the filtered list of maneuvers.
         */
        ManeuverList: {
            /** Items */
            items: components["schemas"]["ManeuverItem"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ManeuverQuality
         * @description Quality of a maneuver; ``content_hash`` is the hash of its inputs.
         */
        ManeuverQuality: {
            /** Maneuver Id */
            maneuver_id: number;
            /** Content Hash */
            content_hash: string;
            verdict: components["schemas"]["QualityVerdict"];
            /** Summary */
            summary: string;
            figures: components["schemas"]["Figures"];
            report: components["schemas"]["QualityReport"];
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * MappedChannel
         * @description A channel of a mapping.
         */
        MappedChannel: {
            /** Name */
            name: string;
            /** Unit */
            unit: string;
            role: components["schemas"]["Role"];
            /** File */
            file: string;
            /** Field */
            field: string;
            /** Rate Hz */
            rate_hz: number;
            /** Start S */
            start_s: number;
            /** N Samples */
            n_samples: number;
            /** Smallest */
            smallest: number;
            /** Largest */
            largest: number;
        };
        /**
         * MappingList
         * @description Stored mappings.
         */
        MappingList: {
            /** Items */
            items: components["schemas"]["StoredMapping"][];
        };
        /**
         * MappingProblem
         * @description An error in a mapping; ``key`` is its key or the channel.
         */
        MappingProblem: {
            /** Code */
            code: string;
            /** Message */
            message: string;
            /** Key */
            key: string | null;
        };
        /**
         * MappingRequest
         * @description A mapping to store under a name.
         */
        MappingRequest: {
            /** Name */
            name: string;
            /** Text */
            text: string;
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * MarginRow
         * @description Stability margins of the loop of one surface at one airspeed.
         *
         *     A margin is null if the loop is unstable or has no crossover. ``gain_std`` is the standard
         *     deviation of the natural logarithm of the gain margin.
         */
        MarginRow: {
            /** Surface */
            surface: string;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Gain */
            gain: number | null;
            /** Gain Std */
            gain_std: number | null;
            /** Phase Rad */
            phase_rad: number | null;
            /** Phase Std Rad */
            phase_std_rad: number | null;
            /** Disk */
            disk: number | null;
            /** Disk Std */
            disk_std: number | null;
        };
        /**
         * MassTable
         * @description Mass properties against fuel fraction; centre of gravity in structural axes.
         */
        MassTable: {
            /** Fuel */
            fuel: number[];
            /** Mass Kg */
            mass_kg: number[];
            /** Pitch Inertia Kg M2 */
            pitch_inertia_kg_m2: number[];
            /** X Cg M */
            x_cg_m: number[];
            /** Z Cg M */
            z_cg_m: number[];
        };
        /**
         * MeasuredResponses
         * @description Frequency responses of a ground vibration test.
         *
         *     ``outputs`` and ``references`` name node and direction (``12+z``). ``arrays`` names
         *     ``frequency`` (M,) [Hz], ``values`` (M, n_outputs, n_references), and where the geometry
         *     is known ``nodes`` (n_outputs, 3) [m] and ``directions`` (n_outputs, 3), structural axes.
         *     ``quantity`` is what the response is: displacement, velocity or acceleration per force.
         */
        MeasuredResponses: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** Fuel */
            fuel: number;
            /** Quantity */
            quantity: string;
            /** Outputs */
            outputs: string[];
            /** References */
            references: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /**
             * Origin
             * @default
             */
            origin: string;
            /** Id */
            id?: number | null;
        };
        /**
         * MeasuredResponsesList
         * @description Sets of measured frequency responses.
         */
        MeasuredResponsesList: {
            /** Items */
            items: components["schemas"]["MeasuredResponses"][];
            /** Next */
            next?: string | null;
        };
        /**
         * Method
         * @description The three maximum-likelihood methods of the paper.
         * @enum {string}
         */
        Method: "OE" | "FRE" | "EE";
        /**
         * ModalDataRequest
         * @description Units, axes and fuel fractions of uploaded modal data; see ``ModalDataOptions``.
         */
        ModalDataRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /** @default FEM */
            kind: components["schemas"]["ModalKind"];
            /** Length Unit */
            length_unit?: ("m" | "mm" | "in" | "ft") | null;
            /** Mass Unit */
            mass_unit?: ("kg" | "t" | "lb" | "slug" | "slinch") | null;
            /** Generalized Mass */
            generalized_mass?: ("file" | "unit" | "unknown") | null;
            /**
             * Axes
             * @default aft right up
             */
            axes: string;
            /**
             * Origin
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            origin: [
                number,
                number,
                number
            ];
            /** Fuel */
            fuel?: {
                [key: string]: number;
            };
            /**
             * Rigid Modes
             * @default false
             */
            rigid_modes: boolean;
            /** Points */
            points?: {
                [key: string]: number;
            };
        };
        /**
         * ModalFile
         * @description Content of one file, as text, and its data sets that are not used.
         */
        ModalFile: {
            /** Name */
            name: string;
            /** Holds */
            holds: string[];
            /** Refused */
            refused: string[];
            /** Has Modes */
            has_modes: boolean;
        };
        /**
         * ModalFiles
         * @description Content of modal data files, and the options that they leave open.
         */
        ModalFiles: {
            /** Files */
            files: components["schemas"]["ModalFile"][];
            /** Frequencies Hz */
            frequencies_hz: number[];
            /** N Nodes */
            n_nodes: number;
            /** Queries */
            queries: components["schemas"]["ModalQuery"][];
        };
        /**
         * ModalKind
         * @description Where a modal table comes from.
         * @enum {string}
         */
        ModalKind: "FEM" | "GVT";
        /**
         * ModalQuery
         * @description An option that no file states.
         */
        ModalQuery: {
            /** Field */
            field: string;
            /** Text */
            text: string;
            /** Choices */
            choices: string[];
        };
        /**
         * ModalTable
         * @description In-vacuo modes against fuel fraction; the numbers themselves are stored arrays.
         *
         *     ``arrays`` names content hashes (F fuels, n modes, P points, G gauges, K nodes):
         *     ``omega`` (F, n) [rad/s], ``zeta`` (F, n), ``mass`` (F, n) [kg m2],
         *     ``shape`` (F, n, P, 6) translation [m] and rotation [rad] per unit eta in body
         *     axes, ``strain`` (F, n, G) per unit eta, ``nodes`` (K, 3) structural axes [m],
         *     ``node_shape`` (F, n, K, 6). Only ``omega`` or ``zeta`` must be there.
         *
         *     Of large structures the shapes at the nodes lie in the table ``modal_shapes``, one array
         *     per fuel weight and mode; ``node_ids`` (K,), ``lines`` (L, 2) between rows of ``nodes``,
         *     and ``shown`` (rows) and ``shown_lines`` what is drawn. ``order`` and ``sign`` (F, n)
         *     track the modes of each row from the first one, ``assurance`` (F, n) is the MAC.
         *
         *     Tables of one name are versions of each other. ``reasons`` are those of name and symmetry
         *     of each mode, ``notes`` the remarks of the import.
         */
        ModalTable: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            kind: components["schemas"]["ModalKind"];
            /** Fuel */
            fuel: number[];
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Symmetric */
            symmetric: boolean[];
            /**
             * Points
             * @default []
             */
            points: string[];
            /**
             * Gauges
             * @default []
             */
            gauges: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Origin
             * @default
             */
            origin: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /**
             * Reasons
             * @default []
             */
            reasons: string[];
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /** Id */
            id?: number | null;
        };
        /**
         * ModalTableDetail
         * @description A modal table with its frequencies [rad/s] and damping ratios, one row per fuel.
         */
        ModalTableDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            kind: components["schemas"]["ModalKind"];
            /** Fuel */
            fuel: number[];
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Symmetric */
            symmetric: boolean[];
            /**
             * Points
             * @default []
             */
            points: string[];
            /**
             * Gauges
             * @default []
             */
            gauges: string[];
            /** Arrays */
            arrays: {
                [key: string]: string;
            };
            /**
             * Origin
             * @default
             */
            origin: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /**
             * Reasons
             * @default []
             */
            reasons: string[];
            /**
             * Notes
             * @default []
             */
            notes: string[];
            /** Id */
            id?: number | null;
            /** Omega */
            omega: number[][] | null;
            /** Zeta */
            zeta: number[][] | null;
        };
        /**
         * ModalTableList
         * @description Modal tables.
         */
        ModalTableList: {
            /** Items */
            items: components["schemas"]["ModalTable"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ModeAtFuel
         * @description One mode of a table at one fuel fraction; numbers that are not known are None.
         */
        ModeAtFuel: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Damping */
            damping: number | null;
            /** Mass Kg M2 */
            mass_kg_m2: number | null;
            /** Followed */
            followed: number | null;
        };
        /**
         * ModeCorrection
         * @description Correction of name and symmetry of a mode by an analyst, with the reason.
         */
        ModeCorrection: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Symmetric */
            symmetric: boolean;
            /** Reason */
            reason: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ModeInBand
         * @description A symmetric mode in the excited band or just above it.
         *
         *     ``air_frequency_hz`` and ``half_power_hz`` (full width at half power) are predicted at the
         *     condition of the maneuver; without a prediction the width is that in vacuo.
         */
        ModeInBand: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Frequency Hz */
            frequency_hz: number;
            /** Air Frequency Hz */
            air_frequency_hz: number | null;
            /** Half Power Hz */
            half_power_hz: number;
            /** In Band */
            in_band: boolean;
            /** Proposed */
            proposed: boolean;
        };
        /**
         * ModeList
         * @description Modes of a table at one fuel fraction, in order of frequency.
         */
        ModeList: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Items */
            items: components["schemas"]["ModeAtFuel"][];
        };
        /**
         * ModeShape
         * @description The shape of one mode at a fuel fraction; see ``DrawnShape``.
         */
        ModeShape: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Fuel */
            fuel: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** N Nodes */
            n_nodes: number;
            /** Nodes M */
            nodes_m: [
                number,
                number,
                number
            ][];
            /** Displacement M */
            displacement_m: [
                number,
                number,
                number
            ][];
            /** Lines */
            lines: [
                number,
                number
            ][];
            /** Largest M */
            largest_m: number;
            /** Span M */
            span_m: number;
            /** Sensors */
            sensors: components["schemas"]["SensorSight"][];
        };
        /**
         * ModelExport
         * @description The model of a run at the condition of its maneuver, in SI units and radians.
         *
         *     x' = A x + B u, y = C x + D u; a sensor measures ``scales`` times y with a
         *     delay of ``delays_s``. ``units`` names the unit of every state, input and output. Instruments
         *     are not part of the model.
         */
        ModelExport: {
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            /** Modes */
            modes: number[];
            /** States */
            states: string[];
            /** Inputs */
            inputs: string[];
            /** Outputs */
            outputs: string[];
            /** Units */
            units: {
                [key: string]: string;
            };
            /** A */
            A: number[][];
            /** B */
            B: number[][];
            /** C */
            C: number[][];
            /** D */
            D: number[][];
            /** Delays S */
            delays_s: number[];
            /** Scales */
            scales: number[];
            /** Derivatives */
            derivatives: {
                [key: string]: number;
            };
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
        };
        /**
         * ModelOrder
         * @description Reduced models of every order at one condition, against the full one.
         */
        ModelOrder: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Modal Table Id */
            modal_table_id: number;
            /** Prediction Id */
            prediction_id: number;
            /** Airspeed M S */
            airspeed_m_s: number;
            /** Fuel */
            fuel: number;
            /** Needed */
            needed: number;
            /** Evidence */
            evidence: string[];
            /** Full */
            full: {
                [key: string]: number;
            };
            /** Steps */
            steps: components["schemas"]["OrderStep"][];
        };
        /**
         * ModelStructure
         * @description A named structure that runs can share, as its newest version has it.
         */
        ModelStructure: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            structure: components["schemas"]["Structure"];
            /**
             * Note
             * @default
             */
            note: string;
            /**
             * Author
             * @default
             */
            author: string;
            /**
             * Version
             * @default 1
             */
            version: number;
            /** Created At */
            created_at?: string | null;
            /** Changed At */
            changed_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * ModelStructureList
         * @description Model structures.
         */
        ModelStructureList: {
            /** Items */
            items: components["schemas"]["ModelStructure"][];
            /** Next */
            next?: string | null;
        };
        /**
         * ModelStructureRequest
         * @description A model structure to store under a name.
         */
        ModelStructureRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            structure: components["schemas"]["StructureRequest"];
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * Notifications
         * @description Decisions awaiting an analyst, and the latest changes (at most 100), newest first.
         */
        Notifications: {
            /** Waiting */
            waiting: components["schemas"]["Waiting"][];
            /** Changes */
            changes: components["schemas"]["Change"][];
        };
        /**
         * Observability
         * @description Observability of modes by sensors, and ranked locations of a further accelerometer.
         *
         *     ``std_error`` is relative to that of the most accurate mode, None for a mode that is not
         *     identifiable.
         */
        Observability: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Numbers */
            numbers: number[];
            /** Names */
            names: string[];
            /** Rows */
            rows: components["schemas"]["SensorRow"][];
            /** Std Error */
            std_error: (number | null)[];
            /** Candidates */
            candidates: components["schemas"]["SensorCandidate"][];
        };
        /**
         * OptimisedAmplitudes
         * @description ``gains`` of the inputs by criterion, peaks of commands and of limited quantities.
         */
        OptimisedAmplitudes: {
            /** Gains */
            gains: {
                [key: string]: {
                    [key: string]: number;
                };
            };
            /** Commands */
            commands: components["schemas"]["OptimisedPeak"][];
            /** Limited */
            limited: components["schemas"]["OptimisedPeak"][];
            /** Errors */
            errors: components["schemas"]["OptimisedError"][];
            /** Next */
            next?: string | null;
        };
        /**
         * OptimisedError
         * @description Relative standard error of a derivative by criterion; ``counts`` in the minimax. [1]
         */
        OptimisedError: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Counts */
            counts: boolean;
            /** Flat */
            flat: number;
            /** Minimax */
            minimax: number;
            /** D Optimal */
            d_optimal: number;
        };
        /**
         * OptimisedPeak
         * @description Peak of a command or of a limited quantity: as designed, minimax and D-optimal.
         *
         *     [unit of the command] or [g]
         */
        OptimisedPeak: {
            /** Name */
            name: string;
            /** Limit */
            limit: number | null;
            /** Flat */
            flat: number;
            /** Minimax */
            minimax: number;
            /** D Optimal */
            d_optimal: number;
        };
        /**
         * OrderStep
         * @description A reduced model with some modes; None for undefined values.
         */
        OrderStep: {
            /** Modes */
            modes: number[];
            /** Names */
            names: string[];
            /** Worst */
            worst: string;
            /** Bias */
            bias: number;
            /** Pole Error */
            pole_error: number | null;
            /** Response Error */
            response_error: number | null;
            /** Poles */
            poles: [
                number,
                number
            ][];
            /** Truncated Poles */
            truncated_poles: [
                number,
                number
            ][];
            /** Residualized */
            residualized: {
                [key: string]: number;
            };
            /** Truncated */
            truncated: {
                [key: string]: number;
            };
            /** Sufficient */
            sufficient: boolean;
        };
        /**
         * Orthogonality
         * @description Shapes over a mass matrix: one on the diagonal; ``worst`` is the largest beside it.
         */
        Orthogonality: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Fuel */
            fuel: number;
            /** Names */
            names: string[];
            /** Values */
            values: number[][];
            /** Worst */
            worst: number;
        };
        /**
         * OrthogonalityRequest
         * @description Field of the mass matrix in the files, and modal table of the shapes.
         */
        OrthogonalityRequest: {
            /** Modal Table Id */
            modal_table_id: number;
            /** Field */
            field: string;
            /**
             * Fuel
             * @default 0.5
             */
            fuel: number;
        };
        /**
         * OutputQuality
         * @description Fit of one output of one block: R2, Theil's inequality, probability of white residuals.
         */
        OutputQuality: {
            /** Block */
            block: string;
            /** Output */
            output: string;
            /** R Squared */
            r_squared: number;
            /** Theil */
            theil: number;
            /** Whiteness */
            whiteness: number;
        };
        /**
         * Pair
         * @description How two sources agree over all derivatives that both estimated.
         *
         *     ``rms_sigma`` is the root mean square of their normalised differences, one where
         *     the scatter matches the standard errors; ``worst`` names the derivative that differs most.
         */
        Pair: {
            /** First */
            first: string;
            /** Second */
            second: string;
            /** N */
            n: number;
            /** Rms Sigma */
            rms_sigma: number;
            /** Chi Square */
            chi_square: number;
            /** Probability */
            probability: number;
            /** Worst */
            worst: string;
            /** Worst Sigma */
            worst_sigma: number;
        };
        /**
         * PairedMode
         * @description A mode of one source and the one of another that is most alike.
         */
        PairedMode: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Other Number */
            other_number: number;
            /** Other Name */
            other_name: string;
            /** Mac */
            mac: number;
            /** Frequency Hz */
            frequency_hz: number;
            /** Other Hz */
            other_hz: number;
            /** Frequency Change */
            frequency_change: number;
            /** Damping */
            damping: number | null;
            /** Other Damping */
            other_damping: number | null;
        };
        /**
         * ParameterEstimate
         * @description One estimated derivative or delay; ``no_error`` is the reason without ``std_error``.
         */
        ParameterEstimate: {
            /** Name */
            name: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
            /** Start */
            start?: number | null;
            /** Cramer Rao */
            cramer_rao?: number | null;
            /** Insensitivity */
            insensitivity?: number | null;
            /** No Error */
            no_error?: string | null;
        };
        /**
         * PartHealth
         * @description State of one part of the workbench, with advice if it is degraded.
         */
        PartHealth: {
            /** Name */
            name: string;
            state: components["schemas"]["PartState"];
            /** Text */
            text: string;
        };
        /**
         * PartState
         * @description State of a part of the workbench.
         * @enum {string}
         */
        PartState: "ok" | "starting" | "degraded";
        /**
         * Participation
         * @description Share of one motion in the root that becomes unstable.
         */
        Participation: {
            /** Name */
            name: string;
            /** Share */
            share: number;
        };
        /**
         * PeakChange
         * @description One peak before and after a flight.
         *
         *     Changes are relative. ``explained`` is the change by fuel burnt in the modal table,
         *     ``unexplained`` the remainder with its standard error.
         */
        PeakChange: {
            /** Mode */
            mode: number;
            /** Name */
            name: string;
            /** Before Hz */
            before_hz: number;
            /** Before Std Hz */
            before_std_hz: number;
            /** After Hz */
            after_hz: number | null;
            /** After Std Hz */
            after_std_hz: number | null;
            /** Change */
            change: number | null;
            /** Explained */
            explained: number;
            /** Unexplained */
            unexplained: number | null;
            /** Unexplained Std */
            unexplained_std: number | null;
            /** Amplitude Change */
            amplitude_change: number | null;
            /** Amplitude Explained */
            amplitude_explained: number;
            /** Amplitude Std */
            amplitude_std: number | null;
            verdict: components["schemas"]["GroundTestVerdict"];
        };
        /**
         * PointAgreement
         * @description COMAC of one point in one direction.
         */
        PointAgreement: {
            /** Point */
            point: string;
            /** Direction */
            direction: string;
            /** Comac */
            comac: number;
        };
        /**
         * Pole
         * @description An eigenvalue of the identified model with its standard errors.
         */
        Pole: {
            /** Real */
            real: number;
            /** Imag */
            imag: number;
            /**
             * Name
             * @default
             */
            name: string;
            /** Real Std */
            real_std?: number | null;
            /** Imag Std */
            imag_std?: number | null;
            /** Frequency */
            frequency?: number | null;
            /** Frequency Std */
            frequency_std?: number | null;
            /** Damping */
            damping?: number | null;
            /** Damping Std */
            damping_std?: number | null;
        };
        /**
         * PredictedLines
         * @description Lines that a candidate was not fitted to: negative log likelihood, and R2.
         */
        PredictedLines: {
            /** Name */
            name: string;
            /** Cost */
            cost: number | null;
            /** R Squared */
            r_squared: number | null;
        };
        /**
         * PredictionDetail
         * @description A prediction with its derivatives at one fuel fraction.
         */
        PredictionDetail: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Source */
            source: string;
            /** Kind */
            kind: string;
            /** Fuel */
            fuel: number[];
            /** Names */
            names: string[];
            /** Values */
            values: string;
            /** Std Errors */
            std_errors?: string | null;
            /**
             * Note
             * @default
             */
            note: string;
            /** Id */
            id?: number | null;
            /** At Fuel */
            at_fuel: number;
            /** Derivatives */
            derivatives: components["schemas"]["DerivativeValue"][];
        };
        /**
         * PredictionList
         * @description Predictions.
         */
        PredictionList: {
            /** Items */
            items: components["schemas"]["DerivativePrediction"][];
            /** Next */
            next?: string | null;
        };
        /**
         * PreflightSimulation
         * @description Design, amplitude, model and controller of a pre-flight simulation, with its run.
         */
        PreflightSimulation: {
            /** Design Id */
            design_id: number;
            /** Level */
            level: number;
            /** Model Run Id */
            model_run_id: number;
            /** Controller Id */
            controller_id: number | null;
            /** Maneuver Id */
            maneuver_id: number;
            /** Run Id */
            run_id: number;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * PreflightSimulationList
         * @description Pre-flight simulations of one design.
         */
        PreflightSimulationList: {
            /** Items */
            items: components["schemas"]["SimulationResult"][];
            /** Next */
            next?: string | null;
        };
        /**
         * PreflightSimulationRequest
         * @description Run whose model is simulated, amplitude level, and controller (none: open loop).
         */
        PreflightSimulationRequest: {
            /** Run Id */
            run_id: number;
            /**
             * Level
             * @default 1
             */
            level: number;
            /** Controller Id */
            controller_id?: number | null;
        };
        /**
         * PreviewRequest
         * @description A mapping and the channels to plot; the first ones if none are given.
         */
        PreviewRequest: {
            /** Mapping */
            mapping: string;
            /**
             * Channels
             * @default []
             */
            channels: string[];
        };
        /**
         * Problem
         * @description Why a request failed (RFC 9457); ``code`` is stable, ``detail`` is for the reader.
         */
        Problem: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            /** Errors */
            errors?: components["schemas"]["FieldError"][] | null;
        };
        /**
         * Progress
         * @description Last progress report of a running job.
         */
        Progress: {
            /**
             * Iteration
             * @default 0
             */
            iteration: number;
            /** Cost */
            cost?: number | null;
            /**
             * Fraction
             * @default 0
             */
            fraction: number;
            /**
             * Message
             * @default
             */
            message: string;
        };
        /**
         * ProgressForecast
         * @description Flutter speed from all runs up to an airspeed, with its 95 % interval.
         */
        ProgressForecast: {
            /** Tested M S */
            tested_m_s: number;
            /** N Runs */
            n_runs: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Low M S */
            low_m_s: number | null;
            /** High M S */
            high_m_s: number | null;
        };
        /**
         * Proposal
         * @description A proposed mapping; ``origin`` is its source.
         */
        Proposal: {
            /** Text */
            text: string;
            /** Origin */
            origin: string;
            /** Fitting */
            fitting: string[];
        };
        /**
         * ProposalBasis
         * @description Reasons for a proposed model structure; stored with the run.
         *
         *     ``decision_id`` names the approval of a baseline, ``run_id`` the run of the same FTA that
         *     used a saved structure.
         */
        ProposalBasis: {
            source: components["schemas"]["ProposalSource"];
            /** Reasons */
            reasons: string[];
            /** Band Hz */
            band_hz: [
                number,
                number
            ];
            /** Decision Id */
            decision_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /** Run Id */
            run_id?: number | null;
        };
        /**
         * ProposalRequest
         * @description A proposed model structure for a range of conditions, with its reasoning and evidence.
         *
         *     ``limits`` are closed intervals; without limits it is proposed for all conditions.
         */
        ProposalRequest: {
            /** Title */
            title: string;
            structure: components["schemas"]["ReferenceRequest"];
            /** Reasoning */
            reasoning: string;
            changes?: components["schemas"]["ReferenceRequest"] | null;
            /** Limits */
            limits?: {
                [key: string]: [
                    number,
                    number
                ];
            } | null;
            /**
             * Run Ids
             * @default []
             */
            run_ids: number[];
            /**
             * Comparisons
             * @default []
             */
            comparisons: components["schemas"]["ComparisonRequest"][];
            /**
             * Figure Ids
             * @default []
             */
            figure_ids: number[];
        };
        /**
         * ProposalSource
         * @description Basis of a proposal, the strongest first.
         * @enum {string}
         */
        ProposalSource: "approved-baseline" | "saved-structure" | "band";
        /**
         * QualityItem
         * @description One item of the list; verdict, summary and figures are None until it is checked.
         */
        QualityItem: {
            /** Maneuver Id */
            maneuver_id: number;
            /** Label */
            label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Fuel Fraction */
            fuel_fraction: number;
            verdict: components["schemas"]["QualityVerdict"] | null;
            /** Summary */
            summary: string | null;
            figures: components["schemas"]["Figures"] | null;
        };
        /**
         * QualityList
         * @description A page of the data quality of a campaign; ``counts`` are numbers of maneuvers by verdict.
         */
        QualityList: {
            /** Items */
            items: components["schemas"]["QualityItem"][];
            /** Counts */
            counts: {
                [key: string]: number;
            };
            assessing: components["schemas"]["Assessing"];
            /** Next */
            next: string | null;
        };
        /**
         * QualityReport
         * @description Quality report of a maneuver; ``not_checked`` lists omitted checks with reasons.
         */
        QualityReport: {
            /** Channels */
            channels: components["schemas"]["ChannelQuality"][];
            condition: components["schemas"]["FlightConditionQuality"];
            /** Inputs */
            inputs: components["schemas"]["InputPair"][];
            /** Warnings */
            warnings: components["schemas"]["QualityWarning"][];
            /** Skew Reference */
            skew_reference: string | null;
            /** Skew Band Hz */
            skew_band_hz: [
                number,
                number
            ] | null;
            /** Not Checked */
            not_checked: string[];
        };
        /**
         * QualityVerdict
         * @description Whether a maneuver may be estimated from; ``unchecked`` where this cannot be concluded.
         * @enum {string}
         */
        QualityVerdict: "good" | "questionable" | "bad" | "unchecked";
        /**
         * QualityWarning
         * @description One thing that an analyst should know; ``good`` is only information.
         */
        QualityWarning: {
            severity: components["schemas"]["QualityVerdict"];
            /** About */
            about: string;
            /** Channel */
            channel: string | null;
            /** Text */
            text: string;
        };
        /**
         * QueueStatus
         * @description The queue: runs by state, recently ended ones, and estimated time until it is empty.
         */
        QueueStatus: {
            /** States */
            states: {
                [key: string]: number;
            };
            /** Ended */
            ended: number;
            /** Window S */
            window_s: number;
            /** Remaining S */
            remaining_s: number | null;
            worker_pool: components["schemas"]["WorkerPool"] | null;
        };
        /**
         * QueuedBatch
         * @description A queued batch; ``repeated`` of its runs had been requested before.
         */
        QueuedBatch: {
            /** Id */
            id: number;
            /** Total */
            total: number;
            /** Repeated */
            repeated: number;
        };
        /**
         * RedesignRequest
         * @description New phases for the harmonics of a design.
         */
        RedesignRequest: {
            /** Name */
            name: string;
            /**
             * Effort
             * @default thorough
             * @enum {string}
             */
            effort: "quick" | "thorough" | "patient";
        };
        /**
         * ReferenceRequest
         * @description One version of one model structure.
         */
        ReferenceRequest: {
            /** Id */
            id: number;
            /** Version */
            version: number;
        };
        /**
         * RescaleRequest
         * @description Factors on the amplitudes of inputs; omitted inputs are unchanged.
         */
        RescaleRequest: {
            /** Name */
            name: string;
            /** Gains */
            gains: {
                [key: string]: number;
            };
            /**
             * Note
             * @default
             */
            note: string;
        };
        /**
         * ResponsesRequest
         * @description Units, axes and fuel fraction of measured frequency responses; see ``ResponseOptions``.
         */
        ResponsesRequest: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Name */
            name: string;
            /**
             * Response Unit
             * @enum {string}
             */
            response_unit: "m/s2" | "g" | "in/s2" | "ft/s2" | "m/s" | "in/s" | "m" | "mm" | "in" | "ft";
            /**
             * Force Unit
             * @enum {string}
             */
            force_unit: "N" | "lbf";
            /**
             * Fuel
             * @default 0
             */
            fuel: number;
            /** Length Unit */
            length_unit?: ("m" | "mm" | "in" | "ft") | null;
            /**
             * Axes
             * @default aft right up
             */
            axes: string;
            /**
             * Origin
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            origin: [
                number,
                number,
                number
            ];
        };
        /**
         * ReviewRules
         * @description How many must approve, and whether one's own proposal may be judged; one per change.
         */
        ReviewRules: {
            /** Aircraft Id */
            aircraft_id: number;
            /**
             * Quorum
             * @default 1
             */
            quorum: number;
            /**
             * Own Allowed
             * @default false
             */
            own_allowed: boolean;
            /**
             * Version
             * @default 0
             */
            version: number;
            /**
             * Reason
             * @default
             */
            reason: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * RevisionRequest
         * @description A proposal that replaces ``revision``.
         */
        RevisionRequest: {
            /** Revision */
            revision: number;
            proposal: components["schemas"]["ProposalRequest"];
        };
        /**
         * Role
         * @description Role of a channel in the identification.
         * @enum {string}
         */
        Role: "input" | "output" | "command" | "condition";
        /**
         * Row
         * @description One derivative; ``values`` follow the order of the sources, None without a value.
         *
         *     ``max_difference_sigma`` is the largest |a - b| / sqrt(sigma_a^2 + sigma_b^2) over
         *     pairs of runs with a standard error; ``consistent`` is whether it is at most 2.
         *     ``mean`` is that of those runs, weighted by their errors, ``chi_square`` their
         *     scatter about it and ``probability`` that of a scatter at least as large. Predictions
         *     take no part: each is judged against the runs in its own value.
         */
        Row: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Values */
            values: (components["schemas"]["SourceValue"] | null)[];
            /** Consistent */
            consistent?: boolean | null;
            /** Max Difference Sigma */
            max_difference_sigma?: number | null;
            /** Mean */
            mean?: number | null;
            /** Mean Std Error */
            mean_std_error?: number | null;
            /** Chi Square */
            chi_square?: number | null;
            /** Probability */
            probability?: number | null;
        };
        /**
         * RulesHistory
         * @description Review rules in force, and all earlier ones, oldest first.
         */
        RulesHistory: {
            current: components["schemas"]["ReviewRules"];
            /** Items */
            items: components["schemas"]["ReviewRules"][];
        };
        /**
         * RulesRequest
         * @description Review rules that replace ``version``, with the reason for the change.
         */
        RulesRequest: {
            /** Quorum */
            quorum: number;
            /** Own Allowed */
            own_allowed: boolean;
            /** Version */
            version: number;
            /** Reason */
            reason: string;
        };
        /**
         * Run
         * @description An estimation run; ``parameters``, ``fit`` and ``poles`` are present once it succeeded.
         *
         *     ``altered`` means that the result or the request does not match the hash stored with it;
         *     ``changed_since`` names data that were corrected since the run was computed, null if an
         *     earlier release did not record its input data. ``repeated`` means that the same run had been
         *     requested before.
         */
        Run: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Modal Table Id */
            modal_table_id: number | null;
            /** Damping Table Id */
            damping_table_id: number | null;
            /** Prediction Id */
            prediction_id: number | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Parameters */
            parameters: components["schemas"]["RunParameter"][];
            fit: components["schemas"]["Fit"] | null;
            /** Poles */
            poles: components["schemas"]["Pole"][];
            /** Blocks */
            blocks: components["schemas"]["RunBlock"][];
            /** Residualized Prediction */
            residualized_prediction: {
                [key: string]: number;
            } | null;
            error: components["schemas"]["RunError"] | null;
            progress: components["schemas"]["Progress"] | null;
            /** Versions */
            versions: {
                [key: string]: string;
            } | null;
            /** Attempt */
            attempt: number;
            /** Author */
            author: string;
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
            /** Deleted At */
            deleted_at: string | null;
            /** Priority */
            priority: number;
            limits: components["schemas"]["Limits"] | null;
            /** After Run Id */
            after_run_id: number | null;
            /** Data Hash */
            data_hash: string | null;
            /** Input Hash */
            input_hash: string | null;
            /** Worker */
            worker: string | null;
            /** Altered */
            altered: boolean;
            /** Changed Since */
            changed_since: string[] | null;
            proposal?: components["schemas"]["ProposalBasis"] | null;
            /** Repeated */
            repeated: boolean;
        };
        /**
         * RunBlock
         * @description One set of data points that was fitted, with its outputs.
         */
        RunBlock: {
            /** Name */
            name: string;
            /** Outputs */
            outputs: string[];
        };
        /**
         * RunError
         * @description Why a run failed.
         */
        RunError: {
            /** Code */
            code: string;
            /** Message */
            message: string;
        };
        /**
         * RunEvent
         * @description An entry of the log of a run; ids increase, so that reading can be resumed.
         *
         *     ``kind`` is ``queued``, ``started``, ``said`` or the state that a run ended in.
         */
        RunEvent: {
            /** Id */
            id: number;
            /** Run Id */
            run_id: number;
            /**
             * At
             * Format: date-time
             */
            at: string;
            /** Kind */
            kind: string;
            /** Attempt */
            attempt: number;
            /**
             * Message
             * @default
             */
            message: string;
        };
        /**
         * RunExport
         * @description A run with its aircraft, flight and maneuver, and the arrays of its result as numbers.
         *
         *     ``covariance`` is ordered as the parameters; both are None and empty until
         *     the run has succeeded.
         */
        RunExport: {
            aircraft: components["schemas"]["Aircraft"];
            flight: components["schemas"]["Flight"];
            maneuver: components["schemas"]["Maneuver"];
            run: components["schemas"]["EstimationRun"];
            /** Covariance */
            covariance: number[][] | null;
            /** Lines */
            lines: components["schemas"]["ExportedLines"][];
        };
        /**
         * RunForecast
         * @description Flutter speed of one run, against the speed at which it was flown.
         *
         *     ``sentence`` is the reason without a flutter speed. ``separation`` is the lowest elastic over
         *     the short-period frequency there; None where the short period does not oscillate.
         */
        RunForecast: {
            /** Run Id */
            run_id: number;
            /** Label */
            label: string;
            /** Tested M S */
            tested_m_s: number;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Sentence */
            sentence: string;
            /** Separation */
            separation: number | null;
        };
        /**
         * RunItem
         * @description One item of the list of runs.
         *
         *     ``worst_r_squared`` is the lowest R2 of all outputs; ``has_model`` is true if the
         *     estimates form a complete model, which has poles.
         */
        RunItem: {
            /** Id */
            id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Maneuver Label */
            maneuver_label: string;
            /** Flight Id */
            flight_id: number;
            /** Flight Number */
            flight_number: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Aircraft Name */
            aircraft_name: string;
            /** Fta */
            fta: number | null;
            /** Airspeed Ratio */
            airspeed_ratio: number | null;
            /** Dynamic Pressure Pa */
            dynamic_pressure_pa: number;
            /** Fuel Fraction */
            fuel_fraction: number;
            method: components["schemas"]["Method"];
            state: components["schemas"]["RunState"];
            /** Modes */
            modes: number[];
            /** Start */
            start: string;
            /** Prediction Id */
            prediction_id: number | null;
            /** Structure Id */
            structure_id: number | null;
            /** Structure Version */
            structure_version: number | null;
            /** Outcome */
            outcome: string | null;
            /** N Iterations */
            n_iterations: number | null;
            /** N Warnings */
            n_warnings: number | null;
            /** Worst R Squared */
            worst_r_squared: number | null;
            /** Has Model */
            has_model: boolean;
            /** Error Code */
            error_code: string | null;
            /** Author */
            author: string;
            /** Tags */
            tags: string[];
            /**
             * Created At
             * Format: date-time
             */
            created_at: string;
            /** Started At */
            started_at: string | null;
            /** Finished At */
            finished_at: string | null;
            /** Deleted At */
            deleted_at: string | null;
            /** Changed Since */
            changed_since: string[];
        };
        /**
         * RunList
         * @description A page of the filtered list of runs.
         */
        RunList: {
            /** Items */
            items: components["schemas"]["RunItem"][];
            /** Next */
            next?: string | null;
        };
        /**
         * RunParameter
         * @description A parameter estimate.
         *
         *     ``cramer_rao`` is the bound for white residuals, ``insensitivity`` the standard error if all
         *     other parameters were known. ``no_error`` is the reason for a missing standard error: the fit
         *     did not converge, the parameter ended at its limit, or it is not identifiable.
         */
        RunParameter: {
            /** Name */
            name: string;
            /** Label */
            label: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
            /** Start */
            start: number | null;
            /** Cramer Rao */
            cramer_rao: number | null;
            /** Insensitivity */
            insensitivity: number | null;
            /** No Error */
            no_error: string | null;
        };
        /**
         * RunProposal
         * @description Modes, inputs, outputs, band and options of a run, and its requirements on the data.
         *
         *     ``inputs`` and ``outputs`` are what the empty ones of the structure stand for;
         *     ``lines_per_parameter`` counts excited frequencies for each parameter of one equation.
         */
        RunProposal: {
            /** Maneuver Id */
            maneuver_id: number;
            basis: components["schemas"]["ProposalBasis"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["RunSettings"];
            /** Inputs */
            inputs: string[];
            /** Outputs */
            outputs: string[];
            /** Modes */
            modes: components["schemas"]["ModeInBand"][];
            /** N Parameters */
            n_parameters: number;
            /** N Lines */
            n_lines: number;
            /** Lines Per Input */
            lines_per_input: {
                [key: string]: number;
            };
            /** Lines Per Parameter */
            lines_per_parameter: number;
            /** Resolution Hz */
            resolution_hz: number;
            /** Warnings */
            warnings: string[];
        };
        /**
         * RunRequest
         * @description Estimate a model of one maneuver by one method.
         *
         *     Omitted ids default to the aircraft's latest tables and the prediction that covers most of the
         *     derivatives. The structure is given in full, or by ``structure_id`` (in
         *     ``structure_version``, the newest if omitted).
         */
        RunRequest: {
            /** Maneuver Id */
            maneuver_id: number;
            method: components["schemas"]["Method"];
            structure?: components["schemas"]["StructureRequest"] | null;
            settings?: components["schemas"]["SettingsRequest"] | null;
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Structure Id */
            structure_id?: number | null;
            /** Structure Version */
            structure_version?: number | null;
            /**
             * Author
             * @default
             */
            author: string;
            /**
             * Priority
             * @default 0
             */
            priority: number;
            limits?: components["schemas"]["LimitsRequest"] | null;
        };
        /**
         * RunResult
         * @description Result of a run; ``covariance`` is a hash, ordered as ``parameters``.
         *
         *     ``prediction_id`` is the prediction that was used, selected or found; ``held`` are
         *     the derivatives that were not free, at the values they were held at.
         */
        RunResult: {
            /** Parameters */
            parameters: components["schemas"]["ParameterEstimate"][];
            /** Covariance */
            covariance: string;
            fit: components["schemas"]["Fit"];
            /** Poles */
            poles: components["schemas"]["Pole"][];
            /** Blocks */
            blocks: components["schemas"]["FitBlock"][];
            /** Residualized Prediction */
            residualized_prediction?: {
                [key: string]: number;
            } | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** Held */
            held?: {
                [key: string]: number;
            };
        };
        /**
         * RunSettings
         * @description Choices of the analyst that are not model structure.
         *
         *     ``noise`` is ``diagonal`` or ``full``; ``priors`` gives value and standard
         *     deviation by parameter, ``prior_spread`` gives every free derivative a prior at
         *     the prediction with this share of its size; ``start_run_id`` goes with the start ``run``;
         *     ``additional_maneuver_ids`` names further maneuvers fitted with the same derivatives.
         */
        RunSettings: {
            /** @default best */
            start: components["schemas"]["Start"];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             */
            noise: string;
            /** Priors */
            priors?: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Prior Spread */
            prior_spread?: number | null;
            /** Start Run Id */
            start_run_id?: number | null;
            /**
             * Additional Maneuver Ids
             * @default []
             */
            additional_maneuver_ids: number[];
        };
        /**
         * RunState
         * @description Life of a run; the run table is the job queue.
         * @enum {string}
         */
        RunState: "queued" | "running" | "succeeded" | "failed" | "cancelled";
        /**
         * SavedView
         * @description ``search`` is the query string of the page.
         */
        SavedView: {
            /** Page */
            page: string;
            /** Name */
            name: string;
            /** Search */
            search: string;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * SavedViewList
         * @description Saved views of a page, or of all.
         */
        SavedViewList: {
            /** Items */
            items: components["schemas"]["SavedView"][];
        };
        /**
         * SavedViewRequest
         * @description The filters of a page to store under a name.
         */
        SavedViewRequest: {
            /**
             * Page
             * @enum {string}
             */
            page: "campaign" | "runs" | "compare" | "flutter";
            /** Name */
            name: string;
            /** Search */
            search: string;
            /**
             * Author
             * @default
             */
            author: string;
        };
        /**
         * SearchCandidate
         * @description A structure on the way, fitted.
         *
         *     ``predictive_cost`` is the negative log likelihood of all lines it did not see, None
         *     where it predicts nothing finite; ``run_id`` is the run that opened it.
         */
        SearchCandidate: {
            /** Name */
            name: string;
            /** Why */
            why: string;
            structure: components["schemas"]["Structure"];
            /** N Terms */
            n_terms: number;
            /** Proposed */
            proposed: boolean;
            /** Converged */
            converged: boolean;
            /** Cost */
            cost: number | null;
            /** Bic */
            bic: number | null;
            /** Likelihood Ratio */
            likelihood_ratio: number | null;
            /** Predicted Ratio */
            predicted_ratio: number | null;
            /** Predicted */
            predicted: components["schemas"]["PredictedLines"][];
            /** Predictive Cost */
            predictive_cost: number | null;
            /** Flutter M S */
            flutter_m_s: number | null;
            /** Flutter Std M S */
            flutter_std_m_s: number | null;
            /** Flutter */
            flutter: string;
            /** Run Id */
            run_id?: number | null;
        };
        /**
         * SearchItem
         * @description A search without its result.
         */
        SearchItem: {
            /** Id */
            id: number;
            /** Aircraft Id */
            aircraft_id: number;
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            /** Modes */
            modes: number[];
            state: components["schemas"]["RunState"];
            /** Sentence */
            sentence: string | null;
            /** Author */
            author: string;
            /** Created At */
            created_at: string | null;
        };
        /**
         * SearchList
         * @description Searches, newest first.
         */
        SearchList: {
            /** Items */
            items: components["schemas"]["SearchItem"][];
        };
        /**
         * SearchRequest
         * @description Maneuvers of a search, and a structure whose free derivatives are the candidate terms.
         */
        SearchRequest: {
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            structure: components["schemas"]["StructureRequest"];
            /**
             * @default {
             *       "algorithm": "stepwise",
             *       "begin": "all",
             *       "f_in": 20,
             *       "f_out": 20,
             *       "pse_noise": 25,
             *       "draws": 30,
             *       "validate_on": [],
             *       "max_iterations": 100,
             *       "noise": "diagonal"
             *     }
             */
            settings: components["schemas"]["SearchSettingsRequest"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
        };
        /**
         * SearchResult
         * @description Result of a search; candidates are in the order of predictive likelihood.
         */
        SearchResult: {
            /** Sentence */
            sentence: string;
            /** Groups */
            groups: components["schemas"]["TermGroup"][];
            /** Candidates */
            candidates: components["schemas"]["SearchCandidate"][];
            /** Warnings */
            warnings: string[];
            /** Seconds */
            seconds: number;
        };
        /**
         * SearchSettings
         * @description Criteria of the selection of terms.
         *
         *     ``f_in`` and ``f_out`` bound the partial F to enter and to stay; ``pse_noise`` is how
         *     many noise variances the predicted squared error charges for a term; ``draws`` is how
         *     often lines are drawn anew; ``validate_on`` names maneuvers that are only predicted.
         */
        SearchSettings: {
            /** @default stepwise */
            algorithm: components["schemas"]["Algorithm"];
            /** @default all */
            begin: components["schemas"]["SearchStart"];
            /**
             * F In
             * @default 20
             */
            f_in: number;
            /**
             * F Out
             * @default 20
             */
            f_out: number;
            /**
             * Pse Noise
             * @default 25
             */
            pse_noise: number;
            /**
             * Draws
             * @default 30
             */
            draws: number;
            /**
             * Validate On
             * @default []
             */
            validate_on: number[];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             */
            noise: string;
        };
        /**
         * SearchSettingsRequest
         * @description Criteria and algorithm of the search; see ``SearchSettings``.
         */
        SearchSettingsRequest: {
            /** @default stepwise */
            algorithm: components["schemas"]["Algorithm"];
            /** @default all */
            begin: components["schemas"]["SearchStart"];
            /**
             * F In
             * @default 20
             */
            f_in: number;
            /**
             * F Out
             * @default 20
             */
            f_out: number;
            /**
             * Pse Noise
             * @default 25
             */
            pse_noise: number;
            /**
             * Draws
             * @default 30
             */
            draws: number;
            /**
             * Validate On
             * @default []
             */
            validate_on: number[];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             * @enum {string}
             */
            noise: "diagonal" | "full";
        };
        /**
         * SearchStart
         * @description Initial model of output error and frequency-response error.
         * @enum {string}
         */
        SearchStart: "all" | "equation error";
        /**
         * SearchStep
         * @description One term in or out, its partial F, and the criteria after it.
         */
        SearchStep: {
            /** Action */
            action: string;
            /** Term */
            term: string;
            /** F */
            f: number;
            /** N Terms */
            n_terms: number;
            /** R Squared */
            r_squared: number | null;
            /** Pse */
            pse: number | null;
            /** Bic */
            bic: number | null;
        };
        /**
         * SearchTerm
         * @description One candidate term at the end.
         *
         *     ``value`` is its estimate, or that as the next to enter; None if linearly dependent.
         *     ``support`` is the fraction of single maneuvers that select it, ``stability`` the fraction of
         *     bootstrap draws that select it, ``inflation`` its variance inflation among
         *     all candidates (None: infinite).
         */
        SearchTerm: {
            /** Name */
            name: string;
            /** Selected */
            selected: boolean;
            /** Value */
            value: number | null;
            /** Std Error */
            std_error: number | null;
            /** F */
            f: number;
            /** Support */
            support: number;
            /** Stability */
            stability: number | null;
            /** Inflation */
            inflation: number | null;
        };
        /**
         * SecondOrder
         * @description Sensor with unit static gain: wn^2 / (s^2 + 2 zeta wn s + wn^2).
         */
        SecondOrder: {
            /** Natural Frequency */
            natural_frequency: number;
            /** Damping */
            damping: number;
        };
        /**
         * Sensor
         * @description One sensor: kind, location and instrument.
         *
         *     ``point`` names a row of the modal table's ``points`` (``gauges`` for a
         *     strain gauge). Locations are in structural axes: x aft, y right, z up [m].
         *     ``noise_std`` is in the SI unit of the channel.
         */
        Sensor: {
            /** Name */
            name: string;
            kind: components["schemas"]["SensorKind"];
            /** Point */
            point: string;
            /**
             * Axis
             * @default z
             */
            axis: string;
            /**
             * Location M
             * @default [
             *       0,
             *       0,
             *       0
             *     ]
             */
            location_m: [
                number,
                number,
                number
            ];
            /** Instrument */
            instrument?: string | null;
            /** Noise Std */
            noise_std?: number | null;
        };
        /**
         * SensorCandidate
         * @description Location of a further accelerometer, with its information and the most improved mode.
         */
        SensorCandidate: {
            /** Node */
            node: number;
            /** Axis */
            axis: string;
            /** Place M */
            place_m: [
                number,
                number,
                number
            ];
            /** Gain */
            gain: number;
            /** Helps */
            helps: string;
            /** Shrinks To */
            shrinks_to: number;
        };
        /**
         * SensorKind
         * @description Measured quantity of a sensor; selects its row in the output equations.
         * @enum {string}
         */
        SensorKind: "accelerometer" | "gyro" | "attitude" | "vane" | "strain";
        /**
         * SensorRow
         * @description How much of each mode one sensor sees: share of the largest motion of that kind.
         */
        SensorRow: {
            /** Sensor */
            sensor: string;
            /** Kind */
            kind: string;
            /** Axis */
            axis: string;
            /** Share */
            share: (number | null)[];
        };
        /**
         * SensorSight
         * @description One mode at one sensor: location, motion and signal.
         */
        SensorSight: {
            /** Sensor */
            sensor: string;
            /** Kind */
            kind: string;
            /** Axis */
            axis: string;
            /** Place M */
            place_m: [
                number,
                number,
                number
            ];
            /** Phi M */
            phi_m: [
                number,
                number,
                number
            ];
            /** Nu Rad */
            nu_rad: [
                number,
                number,
                number
            ];
        };
        /**
         * SettingsRequest
         * @description Settings of the estimation, apart from the model structure.
         */
        SettingsRequest: {
            /** @default best */
            start: components["schemas"]["Start"];
            /** Band Hz */
            band_hz?: [
                number,
                number
            ] | null;
            /**
             * Max Iterations
             * @default 100
             */
            max_iterations: number;
            /**
             * Noise
             * @default diagonal
             * @enum {string}
             */
            noise: "diagonal" | "full";
            /** Priors */
            priors?: {
                [key: string]: [
                    number,
                    number
                ];
            } | null;
            /** Prior Spread */
            prior_spread?: number | null;
            /** Start Run Id */
            start_run_id?: number | null;
            /**
             * Additional Maneuver Ids
             * @default []
             */
            additional_maneuver_ids: number[];
        };
        /**
         * Setup
         * @description A choice of the analyst in which the runs differ; values in the order of the sources.
         */
        Setup: {
            /** Name */
            name: string;
            /** Values */
            values: (string | null)[];
        };
        /**
         * SimulatedDerivative
         * @description A derivative: true value of the simulation, estimate, and predicted standard error.
         */
        SimulatedDerivative: {
            /** Name */
            name: string;
            /** Flown */
            flown: number;
            /** Estimate */
            estimate: number;
            /** Std Error */
            std_error: number | null;
            /** Expected */
            expected: number;
        };
        /**
         * SimulationResult
         * @description A pre-flight simulation, the state of its run, and the derivatives when it succeeded.
         */
        SimulationResult: {
            simulation: components["schemas"]["PreflightSimulation"];
            /** Label */
            label: string;
            state: components["schemas"]["RunState"];
            /** Correlation */
            correlation: number | null;
            /** Derivatives */
            derivatives: components["schemas"]["SimulatedDerivative"][];
        };
        /**
         * SourceValue
         * @description Value of a derivative by one source; ``std_error`` is None if unknown.
         *
         *     Of a prediction, ``difference_sigma`` is the largest |prediction - run| over the runs, in
         *     combined standard errors, and ``consistent`` whether that is at most 2; None of a run, and
         *     where one of the two has no standard error.
         */
        SourceValue: {
            /** Key */
            key: string;
            /** Value */
            value: number;
            /** Std Error */
            std_error?: number | null;
            /** Difference Sigma */
            difference_sigma?: number | null;
            /** Consistent */
            consistent?: boolean | null;
        };
        /**
         * StaleProposal
         * @description Why a vote or revision was refused: ``current`` has replaced ``base``.
         */
        StaleProposal: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            /** Errors */
            errors?: components["schemas"]["FieldError"][] | null;
            base: components["schemas"]["StructureProposal"];
            current: components["schemas"]["StructureProposal"];
            sent: components["schemas"]["StructureProposal"] | null;
            /** Revision */
            revision: number;
        };
        /**
         * StaleStructure
         * @description Why an edit was refused: another version was stored in the meantime.
         *
         *     ``base`` was edited into ``sent``, while ``current`` became the newest version.
         */
        StaleStructure: {
            /** Type */
            type: string;
            /** Title */
            title: string;
            /** Status */
            status: number;
            /** Detail */
            detail: string;
            /** Code */
            code: string;
            base: components["schemas"]["StructureVersion"];
            current: components["schemas"]["StructureVersion"];
            sent: components["schemas"]["StructureVersion"];
        };
        /**
         * Start
         * @description Where the iteration starts; ``best`` takes whichever candidate is likeliest.
         * @enum {string}
         */
        Start: "best" | "prediction" | "residualized-prediction" | "equation-error" | "run";
        /**
         * StepKind
         * @description Kind of correction.
         * @enum {string}
         */
        StepKind: "delay" | "calibration" | "repair";
        /**
         * StepRequest
         * @description One correction; see ``Correction``.
         */
        StepRequest: {
            /** Channel */
            channel: string;
            kind: components["schemas"]["StepKind"];
            /**
             * Delay S
             * @default 0
             */
            delay_s: number;
            /**
             * Scale
             * @default 1
             */
            scale: number;
            /**
             * Bias
             * @default 0
             */
            bias: number;
            /**
             * Stretches
             * @default []
             */
            stretches: [
                number,
                number
            ][];
            /** Std */
            std?: number | null;
            /**
             * Basis
             * @default
             */
            basis: string;
        };
        /**
         * StoredMapping
         * @description A mapping under a name; ``text`` is the TOML as it was written.
         */
        StoredMapping: {
            /** Name */
            name: string;
            /** Text */
            text: string;
            /**
             * Note
             * @default
             */
            note: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * Structure
         * @description The content of a model structure; a run has its own copy.
         *
         *     Empty ``inputs`` or ``outputs`` stand for all that the maneuver has. Each
         *     derivative of the selected modes and inputs is in one state:
         *
         *     - absent, where ``absent`` names it: the model does not have it, it is zero;
         *     - fixed to a number (``fixed``), to a prediction or an earlier run
         *       (``fixed_to``), or, where ``free`` leaves it out, to the start of the run;
         *     - free otherwise; ``free`` of None frees all that is neither absent nor fixed.
         *
         *     ``delays`` [s] of outputs and inputs add to those of their instruments, and
         *     ``instruments`` puts another of the aircraft's instruments (None: none at all)
         *     behind a channel; a combination stands for its sensors.
         */
        Structure: {
            /**
             * Modes
             * @default []
             */
            modes: number[];
            /**
             * Inputs
             * @default []
             */
            inputs: string[];
            /**
             * Outputs
             * @default []
             */
            outputs: string[];
            /** Free */
            free?: string[] | null;
            /** Fixed */
            fixed: {
                [key: string]: number;
            };
            /**
             * Free Delays
             * @default false
             */
            free_delays: boolean;
            /**
             * Extra Parameters
             * @default []
             */
            extra_parameters: string[];
            /**
             * Axis
             * @default longitudinal
             */
            axis: string;
            /**
             * Absent
             * @default []
             */
            absent: string[];
            /** Fixed To */
            fixed_to?: {
                [key: string]: components["schemas"]["FixedTo"];
            };
            /** Delays */
            delays?: {
                [key: string]: number;
            };
            /** Instruments */
            instruments?: {
                [key: string]: string | null;
            };
        };
        /**
         * StructureEditRequest
         * @description A new version of a model structure.
         *
         *     ``version`` is the version that was edited; the header ``If-Match`` can give it instead.
         */
        StructureEditRequest: {
            /** Name */
            name: string;
            structure: components["schemas"]["StructureRequest"];
            /**
             * Note
             * @default
             */
            note: string;
            /** Version */
            version?: number | null;
        };
        /**
         * StructureForecast
         * @description Flutter speed of all runs of one model structure, fused.
         *
         *     ``held_modes`` have predicted derivatives only, and ``source`` is the prediction if they were
         *     included in a second fit; ``unmodelled_modes`` are known to a prediction but not to the
         *     model, whose derivatives include their static response. ``check`` is a second fit with one mode
         *     fewer, of which half of the difference counts. ``airspeed_m_s`` is None where the model stays
         *     stable, or flight contradicts it; ``airspeed_std_m_s`` counts the modal frequencies too.
         */
        StructureForecast: {
            /** Run Ids */
            run_ids: number[];
            /** Modes */
            modes: number[];
            /** Held Modes */
            held_modes: number[];
            /** Unmodelled Modes */
            unmodelled_modes: number[];
            /** Source */
            source: string | null;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Airspeed Std M S */
            airspeed_std_m_s: number | null;
            /** Frequency Rad S */
            frequency_rad_s: number | null;
            /** Sentence */
            sentence: string;
            /** Preferred */
            preferred: boolean;
            /**
             * Check
             * @default false
             */
            check: boolean;
        };
        /**
         * StructureProposal
         * @description Proposed model structure and its evidence.
         *
         *     ``changes`` is the version that ``structure`` changes, where it is not new.
         */
        StructureProposal: {
            /** Title */
            title: string;
            structure: components["schemas"]["StructureReference"];
            changes?: components["schemas"]["StructureReference"] | null;
            /** Limits */
            limits: {
                [key: string]: [
                    number,
                    number
                ];
            };
            /** Reasoning */
            reasoning: string;
            /**
             * Run Ids
             * @default []
             */
            run_ids: number[];
            /**
             * Comparisons
             * @default []
             */
            comparisons: components["schemas"]["LinkedComparison"][];
            /**
             * Figure Ids
             * @default []
             */
            figure_ids: number[];
        };
        /**
         * StructureReference
         * @description One version of one model structure.
         */
        StructureReference: {
            /** Id */
            id: number;
            /** Version */
            version: number;
        };
        /**
         * StructureRequest
         * @description A model structure; see ``Structure``.
         */
        StructureRequest: {
            /**
             * Modes
             * @default []
             */
            modes: number[];
            /**
             * Inputs
             * @default []
             */
            inputs: string[];
            /**
             * Outputs
             * @default []
             */
            outputs: string[];
            /** Free */
            free?: string[] | null;
            /** Fixed */
            fixed?: {
                [key: string]: number;
            } | null;
            /**
             * Free Delays
             * @default false
             */
            free_delays: boolean;
            /**
             * Extra Parameters
             * @default []
             */
            extra_parameters: string[];
            /**
             * Axis
             * @default longitudinal
             * @constant
             */
            axis: "longitudinal";
            /**
             * Absent
             * @default []
             */
            absent: string[];
            /** Fixed To */
            fixed_to?: {
                [key: string]: components["schemas"]["FixedToRequest"];
            } | null;
            /** Delays */
            delays?: {
                [key: string]: number;
            } | null;
            /** Instruments */
            instruments?: {
                [key: string]: string | null;
            } | null;
        };
        /**
         * StructureSearch
         * @description A search that was asked for and, once done, its result.
         *
         *     What ``structure`` frees are the candidates; what it fixes or leaves out stays so.
         */
        StructureSearch: {
            /** Aircraft Id */
            aircraft_id: number;
            /** Maneuver Ids */
            maneuver_ids: number[];
            method: components["schemas"]["Method"];
            structure: components["schemas"]["Structure"];
            settings: components["schemas"]["SearchSettings"];
            /** Modal Table Id */
            modal_table_id?: number | null;
            /** Damping Table Id */
            damping_table_id?: number | null;
            /** Prediction Id */
            prediction_id?: number | null;
            /** @default queued */
            state: components["schemas"]["RunState"];
            progress?: components["schemas"]["Progress"] | null;
            /** Error */
            error?: {
                [key: string]: string;
            } | null;
            result?: components["schemas"]["SearchResult"] | null;
            /** Versions */
            versions?: {
                [key: string]: string;
            } | null;
            /**
             * Author
             * @default
             */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Finished At */
            finished_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * StructureVersion
         * @description One version of a model structure; it is written once and never changed.
         */
        StructureVersion: {
            /** Structure Id */
            structure_id: number;
            /** Version */
            version: number;
            /** Name */
            name: string;
            structure: components["schemas"]["Structure"];
            /** Note */
            note: string;
            /** Author */
            author: string;
            /** Created At */
            created_at?: string | null;
            /** Id */
            id?: number | null;
        };
        /**
         * StructureVersionList
         * @description Versions of a model structure, oldest first.
         */
        StructureVersionList: {
            /** Items */
            items: components["schemas"]["StructureVersion"][];
        };
        /**
         * Surface
         * @description A control surface, or a pair moved as one.
         *
         *     ``symmetry`` of None leaves it to the name; see ``symmetry_of``. ``instrument`` lies
         *     between the true deflection and its recording. Where the command was recorded instead,
         *     ``actuator`` turns it into the true deflection. ``servo`` lies between command and
         *     deflection where both were recorded; control loops are broken in front of it.
         */
        Surface: {
            /** Name */
            name: string;
            /** Instrument */
            instrument?: string | null;
            /** Actuator */
            actuator?: string | null;
            /** Servo */
            servo?: string | null;
            /** Noise Std Rad */
            noise_std_rad?: number | null;
            /** Symmetry */
            symmetry?: ("symmetric" | "antisymmetric" | "single") | null;
        };
        /**
         * TargetMode
         * @description A structural mode that a design targets, with its frequencies over fuel. [Hz]
         *
         *     ``group`` is LE or HE of Table 1, or "all" for a design that is no row of it.
         */
        TargetMode: {
            /** Number */
            number: number;
            /** Name */
            name: string;
            /** Group */
            group: string;
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** In Band */
            in_band: boolean;
        };
        /**
         * TargetModes
         * @description The band of a design [Hz] and the structural modes it targets; ``sentence`` compares them.
         */
        TargetModes: {
            /** Low Hz */
            low_hz: number;
            /** High Hz */
            high_hz: number;
            /** Modes */
            modes: components["schemas"]["TargetMode"][];
            /** Sentence */
            sentence: string;
        };
        /**
         * TaskList
         * @description Tasks of this server since its start.
         */
        TaskList: {
            /** Items */
            items: components["schemas"]["TaskProgress"][];
        };
        /**
         * TaskProgress
         * @description How far a task is; ``made`` is the id of the stored record.
         */
        TaskProgress: {
            /** Id */
            id: string;
            /** Kind */
            kind: string;
            /** Title */
            title: string;
            /**
             * Begun At
             * Format: date-time
             */
            begun_at: string;
            /** Ended At */
            ended_at?: string | null;
            /** @default waiting */
            state: components["schemas"]["TaskState"];
            /**
             * Fraction
             * @default 0
             */
            fraction: number;
            /**
             * Message
             * @default
             */
            message: string;
            /**
             * Code
             * @default
             */
            code: string;
            /** Result Id */
            result_id?: number | null;
        };
        /**
         * TaskState
         * @description State of a task. Tasks end with the server; records made by them remain.
         * @enum {string}
         */
        TaskState: "waiting" | "running" | "done" | "failed" | "cancelled";
        /**
         * TermDependency
         * @description Nearly collinear terms, by their variance proportions in a weak direction.
         */
        TermDependency: {
            /** Condition Index */
            condition_index: number;
            /** Shares */
            shares: {
                [key: string]: number;
            };
        };
        /**
         * TermGroup
         * @description Terms that were searched together: of one coefficient by EE, of the model by OE or FRE.
         */
        TermGroup: {
            /** Name */
            name: string;
            /** Path */
            path: components["schemas"]["SearchStep"][];
            /** Terms */
            terms: components["schemas"]["SearchTerm"][];
            /** Dependencies */
            dependencies: components["schemas"]["TermDependency"][];
            /** R Squared */
            r_squared: number | null;
            /** Pse */
            pse: number | null;
            /** Bic */
            bic: number | null;
        };
        /**
         * ThrustRequest
         * @description Thrust table of one engine as CSV text, and the channels of the rotation speeds.
         *
         *     The first row has a label and total temperatures, every other row a rotation speed and the
         *     thrust at each temperature. Without temperatures the table has two columns.
         */
        ThrustRequest: {
            /** Engines */
            engines: string[];
            /** Text */
            text: string;
            /**
             * Speed Unit
             * @default rpm
             */
            speed_unit: string;
            /**
             * Temperature Unit
             * @default K
             */
            temperature_unit: string;
            /**
             * Thrust Unit
             * @default N
             */
            thrust_unit: string;
            /**
             * Source
             * @default
             */
            source: string;
        };
        /**
         * ThrustTable
         * @description Thrust of one engine, measured in a ground test, against the state of the engine.
         *
         *     ``engines`` are the condition channels of the rotation speeds, one for each engine.
         *     ``thrust_n`` has a row for every rotation speed and a column for every total temperature
         *     of the air; one temperature alone means that thrust does not depend on it.
         */
        ThrustTable: {
            /** Engines */
            engines: string[];
            /** Engine Speed Rad S */
            engine_speed_rad_s: number[];
            /** Total Temperature K */
            total_temperature_k: number[];
            /** Thrust N */
            thrust_n: number[][];
            /**
             * Source
             * @default
             */
            source: string;
        };
        /**
         * TrackerForecast
         * @description Flutter speed by a classical prediction method, or the reason without one.
         */
        TrackerForecast: {
            /** Name */
            name: string;
            /** Airspeed M S */
            airspeed_m_s: number | null;
            /** Sentence */
            sentence: string;
        };
        /**
         * TrendLine
         * @description A weighted fit through the estimates of one method, or a prediction joined up.
         *
         *     ``std_errors`` are None for a prediction. ``probability`` is that of a scatter
         *     about the fit at least as large as found.
         */
        TrendLine: {
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** X */
            x: number[];
            /** Values */
            values: number[];
            /** Std Errors */
            std_errors?: number[] | null;
            /** Slope */
            slope?: number | null;
            /** Slope Std Error */
            slope_std_error?: number | null;
            /** Chi Square */
            chi_square?: number | null;
            /** Freedom */
            freedom?: number | null;
            /** Probability */
            probability?: number | null;
        };
        /**
         * TrendPoint
         * @description One estimate at one condition; ``x`` in SI, a fraction, or the number of the FTA.
         */
        TrendPoint: {
            /** Run Id */
            run_id: number;
            /** Maneuver Id */
            maneuver_id: number;
            /** Label */
            label: string;
            /** Kind */
            kind: string;
            /** X */
            x: number;
            /** Value */
            value: number;
            /** Std Error */
            std_error: number | null;
        };
        /**
         * UnitWarning
         * @description A warning that the samples are too large or too small for their unit.
         *
         *     ``confirmed = ["..."]`` in the mapping of the channel confirms the unit; ``instead`` lists
         *     units in which the samples would be plausible.
         */
        UnitWarning: {
            /** Code */
            code: string;
            /** Channel */
            channel: string;
            /** Unit */
            unit: string;
            /** Largest */
            largest: number;
            /** Instead */
            instead: string[];
        };
        /**
         * UnmodelledModes
         * @description Treatment of the modes omitted by a run.
         * @enum {string}
         */
        UnmodelledModes: "predicted" | "residualized";
        /**
         * UploadDetail
         * @description An upload with the contents of its files and a proposed mapping.
         */
        UploadDetail: {
            upload: components["schemas"]["UploadProgress"];
            /** Files */
            files: components["schemas"]["UploadedFile"][];
            /** Fields */
            fields: components["schemas"]["FoundField"][];
            proposal: components["schemas"]["Proposal"];
        };
        /**
         * UploadList
         * @description Uploads being imported.
         */
        UploadList: {
            /** Items */
            items: components["schemas"]["UploadProgress"][];
        };
        /**
         * UploadMappingRequest
         * @description A TOML mapping for the files of an upload; ``confirmed``: its guesses are confirmed.
         */
        UploadMappingRequest: {
            /** Mapping */
            mapping: string;
            /** Aircraft Id */
            aircraft_id?: number | null;
            /**
             * Confirmed
             * @default false
             */
            confirmed: boolean;
        };
        /**
         * UploadProgress
         * @description An upload with its state; ``progress`` is the fraction written.
         */
        UploadProgress: {
            /** Id */
            id: string;
            /** @default read */
            state: components["schemas"]["UploadState"];
            /** Progress */
            progress?: number | null;
            /** Code */
            code?: string | null;
            /** Message */
            message?: string | null;
            /** Maneuver Id */
            maneuver_id?: number | null;
            /** Flight Id */
            flight_id?: number | null;
            /** N Channels */
            n_channels?: number | null;
        };
        /**
         * UploadState
         * @description State of an upload.
         * @enum {string}
         */
        UploadState: "read" | "importing" | "imported" | "failed";
        /**
         * UploadedFile
         * @description One file of an upload.
         */
        UploadedFile: {
            /** Name */
            name: string;
            /** Sha256 */
            sha256: string;
            /** N Fields */
            n_fields: number;
        };
        /**
         * Vote
         * @description Vote on a proposal.
         * @enum {string}
         */
        Vote: "approve" | "request-changes" | "reject";
        /**
         * VoteRequest
         * @description A vote on ``revision``, with its reason.
         */
        VoteRequest: {
            /** Revision */
            revision: number;
            vote: components["schemas"]["Vote"];
            /** Text */
            text: string;
        };
        /**
         * Waiting
         * @description A decision awaiting this analyst; ``what`` is review or revise.
         */
        Waiting: {
            /** Decision Id */
            decision_id: number;
            /** Title */
            title: string;
            /** What */
            what: string;
            /** Revision */
            revision: number;
            /** Since */
            since: string | null;
        };
        /**
         * WithdrawalRequest
         * @description The reason for withdrawing ``revision``.
         */
        WithdrawalRequest: {
            /** Revision */
            revision: number;
            /** Text */
            text: string;
        };
        /**
         * WorkerPool
         * @description The dispatching server, its number of workers, and their runs.
         *
         *     ``without_workers_s`` is the time since the last worker was connected. [s]
         */
        WorkerPool: {
            /** Server */
            server: string;
            /** Place */
            place: string;
            /** Workers */
            workers: number;
            /** Running */
            running: number[];
            /**
             * Without Workers S
             * @default 0
             */
            without_workers_s: number;
        };
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export interface operations {
    get_health: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Health"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_aircraft: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AircraftList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_aircraft: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    set_thrust: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ThrustRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    remove_thrust: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Aircraft"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_flights: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlightList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_flight: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Flight"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_flight_channels: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlightChannelList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    find_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FoundManeuverList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    cut_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CutRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_ground_tests: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["GroundTestList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_ground_test: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                flight_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["GroundTest"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_maneuvers: {
        parameters: {
            query?: {
                /** @description `-` for descending order, then one of aircraft_name, airspeed_m_s, airspeed_ratio, axis, created_at, duration_s, dynamic_pressure_pa, flight_number, fta, fuel_fraction, id, label, max_input_correlation, n_runs. */
                sort?: string;
                /** @description Maximum number of items. */
                limit?: number;
                /** @description `next` of the previous page. */
                after?: string | null;
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Text contained in label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only maneuvers with this tag. */
                tag?: string | null;
                /** @description Deleted maneuvers instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    upload_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_maneuver"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_maneuver_facets: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Text contained in label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only maneuvers with this tag. */
                tag?: string | null;
                /** @description Deleted maneuvers instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Facets"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    change_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ChangeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ChangedRecords"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_maneuver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_run_proposal: {
        parameters: {
            query?: {
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Ids of maneuvers to be fitted together with this one. */
                additional_maneuver_ids?: string | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunProposal"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_quality: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverQuality"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_conditioning: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    add_conditioning: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ConditioningRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    undo_conditioning: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                maneuver_id: number;
                /** @description Id of the record. */
                step_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConditioningStep"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_qualities: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description `missing`: maneuvers not assessed yet. */
                verdict?: ("good" | "questionable" | "bad" | "unchecked" | "missing") | null;
                search?: string | null;
                /** @description `-` for descending order, then one of airspeed_drift, airspeed_ratio, flight_number, fuel_change, label, largest_skew_s, least_coherence, max_input_correlation, n_stretches, saturated, signal_to_noise_db, verdict. */
                sort?: string;
                /** @description Maximum number of items. */
                limit?: number;
                /** @description `next` of the previous page. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QualityList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    assess_maneuvers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["AssessRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Assessing"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    stop_assessment: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Assessing"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_mappings: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    add_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["MappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredMapping"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                mapping_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredMapping"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_mapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                mapping_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_imports: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    upload_files: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_files"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_upload_state: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    check_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UploadMappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Checked"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    preview_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PreviewRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    import_upload: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UploadMappingRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UploadProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_modal_tables: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                kind?: components["schemas"]["ModalKind"] | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTableList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_model_order: {
        parameters: {
            query: {
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelOrder"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_modal_table: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTableDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_modal_table: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_modes: {
        parameters: {
            query?: {
                /** @description Fuel fraction. */
                fuel?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModeList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_shape: {
        parameters: {
            query: {
                /** @description Number of the mode. */
                number: number;
                /** @description Fuel fraction. */
                fuel?: number;
                /** @description All nodes, instead of a thinned set. */
                every_node?: boolean;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModeShape"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_correlation: {
        parameters: {
            query: {
                other_id: number;
                /** @description Fuel fraction. */
                fuel?: number;
                other_fuel?: number | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Correlation"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_observability: {
        parameters: {
            query?: {
                /** @description Fuel fraction. */
                fuel?: number;
                symmetry?: "symmetric" | "antisymmetric" | "all";
                up_to_hz?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Observability"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    download_modes: {
        parameters: {
            query?: {
                form?: "uff" | "csv";
                /** @description Fuel fraction. */
                fuel?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    /**
                     * @example frequency_hz,bfs,wf1s
                     *     0.25,1.02,0.44
                     */
                    "text/csv": unknown;
                    /** @example static const float design_t[2400][5] = { */
                    "text/plain": unknown;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    correct_mode: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                modal_table_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CorrectionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModeCorrection"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    inspect_modal_files: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalFiles"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    import_modal_data: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ModalDataRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTable"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    import_flutter_summary: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FlutterSummaryRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_flutter_summaries: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummaryList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_flutter_summary: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                summary_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FlutterSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    import_responses: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ResponsesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponses"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_measured_responses: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponsesList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_measured_responses: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MeasuredResponses"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    identify_modes: {
        parameters: {
            query?: {
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Highest model order. */
                order?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FoundModes"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    save_identified_modes: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                responses_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["IdentifiedModesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModalTable"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    check_orthogonality: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the upload. */
                upload_id: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["OrthogonalityRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Orthogonality"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_predictions: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PredictionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_prediction: {
        parameters: {
            query?: {
                /** @description Fuel fraction; by default the first. */
                fuel?: number | null;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                prediction_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PredictionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_model_structures: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructureList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    add_model_structure: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ModelStructureRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_model_structure: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    edit_model_structure: {
        parameters: {
            query?: never;
            header?: {
                /** @description Version that was edited, e.g. `"3"`. */
                "if-match"?: string | null;
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["StructureEditRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelStructure"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleStructure"] | components["schemas"]["Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_structure_versions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureVersionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_structure_version: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                structure_id: number;
                /** @description Version of the record. */
                version: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureVersion"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_decisions: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                state?: components["schemas"]["DecisionState"] | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    propose_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ProposalRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_campaign_audit: {
        parameters: {
            query: {
                aircraft_id: number;
                /** @description JSON, or Markdown to read. */
                format?: "json" | "markdown";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AuditTrail"];
                    "text/markdown": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_decision: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    revise_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RevisionRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    comment_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CommentRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    vote_on_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VoteRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    withdraw_decision: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["WithdrawalRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecisionDetail"];
                };
            };
            /** @description Conflict */
            409: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["StaleProposal"] | components["schemas"]["Problem"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_decision_audit: {
        parameters: {
            query?: {
                /** @description JSON, or Markdown to read. */
                format?: "json" | "markdown";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AuditTrail"];
                    "text/markdown": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_review_rules: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RulesHistory"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    change_review_rules: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                aircraft_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RulesRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ReviewRules"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_campaign_baselines: {
        parameters: {
            query: {
                aircraft_id: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BaselineList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_maneuver_baselines: {
        parameters: {
            query: {
                /** @description Ids of maneuvers, separated by commas. */
                maneuver_ids: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ManeuverBaselineList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    freeze_figure: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FreezeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FrozenFigure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_frozen_figure: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                figure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FrozenFigure"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_notifications: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Notifications"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    mark_notifications_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    mark_decision_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    mark_structure_seen: {
        parameters: {
            query?: never;
            header: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst": string;
            };
            path: {
                /** @description Id of the record. */
                structure_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_runs: {
        parameters: {
            query?: {
                /** @description `-` for descending order, then one of airspeed_ratio, author, created_at, dynamic_pressure_pa, finished_at, flight_number, fta, fuel_fraction, id, maneuver_label, method, state. */
                sort?: string;
                /** @description Maximum number of items. */
                limit?: number;
                /** @description `next` of the previous page. */
                after?: string | null;
                aircraft_id?: number | null;
                flight_id?: number | null;
                maneuver_id?: number | null;
                structure_id?: number | null;
                fta?: number | null;
                min_airspeed_ratio?: number | null;
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                method?: components["schemas"]["Method"] | null;
                state?: components["schemas"]["RunState"] | null;
                /** @description Only runs with this tag. */
                tag?: string | null;
                /** @description Text contained in maneuver or author, or an id. */
                search?: string | null;
                /** @description Deleted runs instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    request_run: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RunRequest"];
            };
        };
        responses: {
            /** @description The same run had been requested before */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_run_facets: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
                flight_id?: number | null;
                maneuver_id?: number | null;
                structure_id?: number | null;
                fta?: number | null;
                min_airspeed_ratio?: number | null;
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                method?: components["schemas"]["Method"] | null;
                state?: components["schemas"]["RunState"] | null;
                /** @description Only runs with this tag. */
                tag?: string | null;
                /** @description Text contained in maneuver or author, or an id. */
                search?: string | null;
                /** @description Deleted runs instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Facets"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    change_runs: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ChangeRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ChangedRecords"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_run: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_run: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_run_export: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RunExport"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_run_model: {
        parameters: {
            query?: {
                /** @description `mat` for MATLAB. */
                format?: "json" | "mat";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ModelExport"];
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_saved_views: {
        parameters: {
            query?: {
                page?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SavedViewList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    add_saved_view: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SavedViewRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SavedView"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_saved_view: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                view_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_searches: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SearchList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    request_search: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SearchRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_search: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                search_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    cancel_search: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                search_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StructureSearch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    create_candidate_run: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path: {
                /** @description Id of the record. */
                search_id: number;
                /** @description Index of the candidate, from 0. */
                place: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Run"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_jobs: {
        parameters: {
            query?: {
                state?: components["schemas"]["RunState"] | null;
                batch_id?: number | null;
                /** @description Ids of jobs, separated by commas. */
                ids?: string | null;
                /** @description Maximum number of items. */
                limit?: number;
                /** @description `next` of the previous page. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["JobList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_queue_status: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QueueStatus"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_job_log: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["JobLog"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    cancel_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    retry_job: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                job_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    stream_events: {
        parameters: {
            query?: {
                /** @description Id of the last known event. */
                after?: number | null;
            };
            header?: {
                "last-event-id"?: string | null;
            };
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    /**
                     * @example id: 12
                     *     event: run
                     *     data: {"run_id": 1, "state": "succeeded"}
                     */
                    "text/event-stream": unknown;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_batches: {
        parameters: {
            query?: {
                /** @description Maximum number of items. */
                limit?: number;
                /** @description `next` of the previous page. */
                after?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    request_batch: {
        parameters: {
            query?: never;
            header?: {
                /** @description Name of the analyst, percent-encoded UTF-8; not authenticated. */
                "X-Flexsid-Analyst"?: string;
            };
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["BatchRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["QueuedBatch"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    cancel_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    retry_batch: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                batch_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["BatchProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_comparison: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Comparison"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_trend: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                against?: components["schemas"]["Against"];
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description Degree of the weighted polynomial. */
                degree?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DerivativeTrend"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    report_run: {
        parameters: {
            query?: {
                /** @description `pdf` requires Chromium on the server. */
                format?: "html" | "pdf";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                run_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    report_comparison: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description `pdf` requires Chromium on the server. */
                format?: "html" | "pdf";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    report_decision: {
        parameters: {
            query?: {
                /** @description `pdf` requires Chromium on the server. */
                format?: "html" | "pdf";
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                decision_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    report_campaign: {
        parameters: {
            query?: {
                /** @description `pdf` requires Chromium on the server. */
                format?: "html" | "pdf";
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Text contained in label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only maneuvers with this tag. */
                tag?: string | null;
                /** @description Deleted maneuvers instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                    "application/pdf": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_designs: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    create_design: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    start_design: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    import_multisines: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_import_multisines"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_catalogue: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["CatalogueList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    check_design: {
        parameters: {
            query: {
                /** @description Natural frequency of the actuator. [rad/s] */
                natural_frequency: number;
                damping?: number;
                delay_s?: number;
                /** @description [rad], at most 1.05 (60 deg). */
                position?: number | null;
                /** @description [rad/s], at most 50 (2900 deg/s). */
                rate?: number | null;
                acceleration?: number | null;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DesignChecks"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_target_modes: {
        parameters: {
            query: {
                aircraft_id: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TargetModes"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    predict_errors: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExpectedErrors"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    predict_response: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExpectedSummary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    compare_classic_inputs: {
        parameters: {
            query: {
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["InputComparison"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    optimise_amplitudes: {
        parameters: {
            query: {
                run_id: number;
                /** @description [rad], at most 1.05 (60 deg). */
                deflection?: number | null;
                load_factor?: number | null;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["OptimisedAmplitudes"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    rescale_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RescaleRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ExcitationDesign"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    redesign_phases: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RedesignRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_preflight_simulations: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PreflightSimulationList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    simulate_design: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PreflightSimulationRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    export_design: {
        parameters: {
            query?: {
                form?: "csv" | "mat" | "h" | "json";
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
            };
            header?: never;
            path: {
                /** @description Id of the record. */
                design_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/csv": string;
                    "application/octet-stream": string;
                    "text/plain": string;
                    "application/json": Record<string, never>;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_controllers: {
        parameters: {
            query?: {
                aircraft_id?: number | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ControllerList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    create_controller: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ControllerRequest"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    upload_controller: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "multipart/form-data": components["schemas"]["Body_upload_controller"];
            };
        };
        responses: {
            /** @description Successful Response */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_controller: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                controller_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Controller"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    delete_controller: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description Id of the record. */
                controller_id: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    start_flutter_prediction: {
        parameters: {
            query: {
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_flutter: {
        parameters: {
            query: {
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Flutter"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    start_closed_loop_analysis: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            202: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_closed_loop: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ClosedLoopStability"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_tasks: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskList"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    get_task: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                task_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    cancel_task: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                task_id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TaskProgress"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_envelope: {
        parameters: {
            query?: {
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                aircraft_id?: number | null;
                flight_id?: number | null;
                /** @description Number of the flight-test aid. */
                fta?: number | null;
                /** @description Least V/V_f. */
                min_airspeed_ratio?: number | null;
                /** @description Largest V/V_f. */
                max_airspeed_ratio?: number | null;
                min_fuel?: number | null;
                max_fuel?: number | null;
                /** @description Text contained in label, note, file or aircraft. */
                search?: string | null;
                /** @description Only maneuvers with a run of this method. */
                method?: components["schemas"]["Method"] | null;
                /** @description State of the newest run, of `method` or of any. */
                state?: components["schemas"]["RunState"] | null;
                /** @description Mini-GVT records on the runway instead of flown maneuvers. */
                ground?: boolean;
                /** @description Only maneuvers with this tag. */
                tag?: string | null;
                /** @description Deleted maneuvers instead. */
                deleted?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_time_history: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                start_s?: number | null;
                stop_s?: number | null;
                points?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_flight_history: {
        parameters: {
            query: {
                flight_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                start_s?: number | null;
                stop_s?: number | null;
                points?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_spectrum: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                /** @description With the full spectrum. */
                full?: boolean;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_signal_to_noise: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_plot_matrix: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Names separated by commas. */
                channels?: string | null;
                domain?: "time" | "frequency";
                /** @description Mode numbers: draws the equation-error regressors instead. */
                modes?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_bode: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Outputs separated by commas. */
                output: string;
                /** @description Names separated by commas. */
                inputs?: string | null;
                /** @description Ids separated by commas. */
                run_id?: string | null;
                /** @description Ids of maneuvers to overlay. */
                overlay?: string | null;
                /** @description Average the frequency response over all maneuvers. */
                average?: boolean;
                /** @description Also models without modes in the sensor equations. */
                rigid?: boolean;
                /** @description From averaged windows, as if no harmonics were known. */
                windowed?: boolean;
                view?: "bode" | "nichols" | "nyquist";
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_reconstruction: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description alpha, q, CZ, Cm, CQ7, eta7, etaddot7 ..., separated by commas. */
                quantities?: string | null;
                /** @description Mode numbers; by default those that are excited. */
                modes?: string | null;
                domain?: "time" | "frequency";
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_loops: {
        parameters: {
            query: {
                maneuver_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_ground_test: {
        parameters: {
            query: {
                flight_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_fit: {
        parameters: {
            query: {
                run_id: number;
                /** @description Names separated by commas. */
                output?: string | null;
                /** @description Set of data points; by default the first of the run. */
                block?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_residual: {
        parameters: {
            query: {
                run_id: number;
                /** @description Set of data points; by default the first of the run. */
                block?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_parameter_correlation: {
        parameters: {
            query: {
                run_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_poles: {
        parameters: {
            query: {
                /** @description Ids of runs, separated by commas. */
                run_id: string;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_iterations: {
        parameters: {
            query: {
                run_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_time_check: {
        parameters: {
            query: {
                run_id: number;
                /** @description Names separated by commas. */
                outputs?: string | null;
                maneuver_id?: number | null;
                points?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_derivatives: {
        parameters: {
            query: {
                /** @description Ids separated by commas. */
                run_ids: string;
                /** @description Ids separated by commas. */
                prediction_ids?: string | null;
                /** @description CZ, Cm, CQ7 ... */
                coefficient?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_forest: {
        parameters: {
            query: {
                /** @description Ids separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                /** @description Ids separated by commas. */
                prediction_ids?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_trend: {
        parameters: {
            query: {
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of runs, separated by commas. */
                run_ids: string;
                /** @description Derivative, e.g. Cm_alpha. */
                name: string;
                against?: components["schemas"]["Against"];
                /** @description Ids of predictions, separated by commas. */
                prediction_ids?: string | null;
                /** @description Degree of the weighted polynomial. */
                degree?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_v_omega_zeta: {
        parameters: {
            query: {
                /** @description Variable over which the roots are tracked. */
                along?: components["schemas"]["Along"];
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_root_locus: {
        parameters: {
            query: {
                /** @description Variable over which the roots are tracked. */
                along?: components["schemas"]["Along"];
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_equivalent_modes: {
        parameters: {
            query: {
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_flutter_forecast: {
        parameters: {
            query: {
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_flutter_map: {
        parameters: {
            query: {
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_closed_loop_margins: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_closed_loop_roots: {
        parameters: {
            query: {
                controller_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                /** @description Ids of succeeded runs, separated by commas. */
                run_ids: string;
                /** @description Fuel fraction; by default that of the fastest test point. */
                fuel?: number | null;
                /** @description Standard altitude; by default the air of the fastest test point. */
                altitude_m?: number | null;
                /** @description Airspeed of the next test point; by default 3 % above the fastest. */
                next_m_s?: number | null;
                /** @description Modes not modelled by the runs: with predicted dynamics, or residualised. */
                others?: components["schemas"]["UnmodelledModes"];
                /** @description Linear trend of the derivatives with dynamic pressure. */
                trend?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_search_path: {
        parameters: {
            query: {
                search_id: number;
                /** @description Coefficient (EE) or method; by default the first. */
                group?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_search_stability: {
        parameters: {
            query: {
                search_id: number;
                /** @description Coefficient (EE) or method; by default the first. */
                group?: string | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_design_history: {
        parameters: {
            query: {
                design_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_design_spectrum: {
        parameters: {
            query: {
                design_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_design_information: {
        parameters: {
            query: {
                design_id: number;
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_design_signal: {
        parameters: {
            query: {
                design_id: number;
                run_id: number;
                /** @description Amplitude: 0 low, 1 medium, 2 high. */
                level?: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_frozen: {
        parameters: {
            query: {
                figure_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_modes_against_fuel: {
        parameters: {
            query: {
                modal_table_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_mac: {
        parameters: {
            query: {
                modal_table_id: number;
                /** @description Fuel fraction. */
                fuel?: number;
                other_id?: number | null;
                other_fuel?: number | null;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_model_order: {
        parameters: {
            query: {
                /** @description Derivatives to draw, separated by commas. */
                derivatives?: string;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_reduced_responses: {
        parameters: {
            query: {
                output: string;
                surface: string;
                /** @description Numbers of retained modes, separated by commas. */
                counts?: string;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                aircraft_id: number;
                airspeed_m_s: number;
                /** @description Fuel fraction. */
                fuel?: number;
                altitude_m?: number;
                modal_table_id?: number | null;
                prediction_id?: number | null;
                low_hz?: number;
                high_hz?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    draw_stabilisation: {
        parameters: {
            query: {
                responses_id: number;
                /** @description Plotly figure, or its data as CSV or MAT. */
                format?: "json" | "csv" | "mat";
                low_hz?: number | null;
                high_hz?: number | null;
                /** @description Highest model order. */
                order?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Figure"];
                    "text/csv": string;
                    "application/octet-stream": string;
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    list_nomenclature: {
        parameters: {
            query?: {
                /** @description Channels, derivatives or symbols, separated by commas; all if omitted. */
                names?: string | null;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Successful Response */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Glossary"];
                };
            };
            /** @description Client Error */
            "4XX": {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
}
