{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<header>
<h1>Fleet</h1>
<p class="meta" id="summary" data-fresh>{{SUMMARY}}{{#PART}} &middot; <a href="?verdict={{VALUE}}">{{TEXT}}</a>{{/PART}}{{#BOARDS}} &middot; <a href="boards/">{{TEXT}}</a>{{/BOARDS}}{{#EXPERIMENTS}} &middot; <a href="experiments/">{{COUNT}}</a>{{/EXPERIMENTS}}{{#RIG_MODELS}} &middot; <a href="models/">rig models</a>{{/RIG_MODELS}}</p>
</header>
<div id="centre" data-fresh>{{#CENTRE}}<p class="meta">{{TEXT}}</p>{{/CENTRE}}</div>
<div id="work" data-fresh>
{{#WORK}}
<section class="card work" aria-label="Work lists">
{{#CAUSES}}
<div>
<h2>By cause</h2>
<ul>
{{#ITEM}}<li><a href="?cause={{KEY}}">{{TEXT}}</a>: {{ROBOTS}}</li>
{{/ITEM}}
{{#MORE}}<li class="soft">others on fewer robots: <a href="fleet.csv" download>all robots as CSV</a></li>{{/MORE}}
</ul>
</div>
{{/CAUSES}}
{{#MODELS}}
<div>
<h2>By rig model <span class="soft">robots that need somebody</span></h2>
<ul>
{{#ITEM}}<li><a href="?model={{KEY}}&amp;status=work">{{TEXT}}</a>: {{ROBOTS}}</li>
{{/ITEM}}
</ul>
</div>
{{/MODELS}}
{{#WEEKS}}
<div>
<h2>By due week</h2>
<ul>
{{#ITEM}}<li><a href="?verdict={{VALUE}}">{{TEXT}}</a>: {{ROBOTS}}</li>
{{/ITEM}}
</ul>
</div>
{{/WEEKS}}
{{#STATUSES}}
<div>
<h2>By status</h2>
<ul>
{{#ITEM}}<li><a href="?status={{VALUE}}">{{VALUE}}</a>: {{ROBOTS}}</li>
{{/ITEM}}
</ul>
</div>
{{/STATUSES}}
</section>
{{/WORK}}
</div>
{{#ROBOTS}}
<form class="search" role="search" action="./" method="get">
<label>Search <input type="search" name="q" value="{{SEARCH}}"></label>
<label>Show <select name="verdict">{{#CHOICE}}<option value="{{VALUE}}"{{#CHOSEN}} selected{{/CHOSEN}}>{{NAME}}</option>{{/CHOICE}}</select></label>
<label>Status <select name="status">{{#STATUS_CHOICE}}<option value="{{VALUE}}"{{#CHOSEN}} selected{{/CHOSEN}}>{{NAME}}</option>{{/STATUS_CHOICE}}</select></label>
<input type="hidden" name="sort" value="{{SORT}}"><input type="hidden" name="order" value="{{ORDER}}">{{#FORM_CAUSE}}<input type="hidden" name="cause" value="{{KEY}}">{{/FORM_CAUSE}}{{#FORM_MODEL}}<input type="hidden" name="model" value="{{NAME}}">{{/FORM_MODEL}}{{#FORM_SITE}}<input type="hidden" name="site" value="{{PLACE}}">{{/FORM_SITE}}
<button>Show</button>
</form>
<section class="card" id="live" data-fresh data-live="api/v1/live">
{{#ONLY}}<p class="only"><bdi>{{TEXT}}</bdi> <a href="?q={{SEARCH}}&amp;verdict={{VERDICT}}&amp;sort={{SORT}}&amp;order={{ORDER}}{{#CAUSE}}&amp;cause={{KEY}}{{/CAUSE}}{{#ONLY_STATUS}}&amp;status={{WORD}}{{/ONLY_STATUS}}{{#ONLY_SITE}}&amp;site={{PLACE}}{{/ONLY_SITE}}{{#ONLY_MODEL}}&amp;model={{NAME}}{{/ONLY_MODEL}}">{{BACK}}</a></p>{{/ONLY}}
<p class="count" role="status">{{COUNT}}</p>
<div class="scroll" tabindex="0" role="region" aria-label="Robots">
<table class="list fleet">
<thead><tr>{{#COLUMN}}<th scope="col"{{#SORTED}} aria-sort="{{DIRECTION}}"{{/SORTED}}>{{#HEADING}}<a href="?q={{SEARCH}}&amp;verdict={{VERDICT}}&amp;sort={{SORT}}&amp;order={{ORDER}}{{#CAUSE}}&amp;cause={{KEY}}{{/CAUSE}}{{#ONLY_STATUS}}&amp;status={{WORD}}{{/ONLY_STATUS}}{{#ONLY_SITE}}&amp;site={{PLACE}}{{/ONLY_SITE}}{{#ONLY_MODEL}}&amp;model={{NAME}}{{/ONLY_MODEL}}"{{#CHOSEN}} aria-current="true"{{/CHOSEN}}>{{NAME}} <span aria-hidden="true">{{ARROW}}</span></a> {{/HEADING}}</th>{{/COLUMN}}</tr></thead>
<tbody>
{{#ROW}}
<tr{{#OVERDUE}} class="overdue"{{/OVERDUE}}><th scope="row"><a href="robots/{{ROBOT}}/">{{ROBOT}}</a></th><td class="text verdict">{{#OVERDUE}}<span class="badge warn">{{BADGE}}</span> {{/OVERDUE}}{{#LATER}}<template data-from="{{UNTIL}}"><span class="badge warn">{{BADGE}}</span> <strong class="drive">{{TEXT}}</strong> </template>{{/LATER}}<span class="badge {{LEVEL}} then">{{WORD}}</span> {{#OVERDUE}}<strong class="drive">{{TEXT}}</strong> {{/OVERDUE}}{{#DRIVE}}<strong class="drive{{#ENDS}} until{{/ENDS}}" dir="auto">{{TEXT:x-typed}}</strong> {{/DRIVE}}<span class="why" dir="auto">{{WHY:x-typed}}</span>{{#DO}} <span class="do" dir="auto">{{WHAT_TO_DO:x-typed}}</span>{{/DO}}{{#KEEP}} <span class="do">{{TEXT}}</span>{{/KEEP}}{{#RUNS}} <span class="do">{{TEXT}}</span>{{/RUNS}}</td><td class="text" data-label="Status"><span class="badge {{STATUS_LEVEL}}">{{STATUS}}</span>{{#STATUS_WHY}} <span class="why" dir="auto">{{TEXT:x-typed}}</span>{{/STATUS_WHY}}{{#STATUS_DO}} <span class="do" dir="auto">{{TEXT:x-typed}}</span>{{/STATUS_DO}}</td>{{#PLACES}}<td class="text place"{{#PLACED}} data-label="{{LABEL}}"{{/PLACED}}>{{#MODEL}}<a class="name" dir="auto" href="?model={{KEY}}">{{TEXT}}</a>{{/MODEL}}{{#SITE}} <a class="soft name" dir="auto" href="?site={{KEY}}">{{TEXT}}</a>{{/SITE}}</td>{{/PLACES}}<td class="text" data-label="Calibrated">{{AGE}}{{#DUE}} <span class="soft due">due {{DAY}}</span>{{/DUE}}{{#DRIFT}} <span class="soft">{{TEXT}}</span>{{/DRIFT}}</td><td class="text" data-label="Last session">{{LAST}}{{#OPERATOR}} <span class="soft operator">by <bdi>{{TEXT}}</bdi></span>{{/OPERATOR}}{{#WORKING}} <span class="busy">{{TEXT}}</span>{{/WORKING}}</td><td class="text worst" data-label="Worst edge">{{#WORST}}<span class="badge {{LEVEL}}">{{SIGMAS}} &sigma;</span> <span class="pair">{{FROM}} &rarr; {{TO}}</span>{{/WORST}}{{#NO_WORST}}<span class="soft">not known</span>{{/NO_WORST}}{{#STRIP}} {{>DRAWING}}{{/STRIP}}</td><td class="text counts" data-label="Revision">{{#REVISION}}<a href="robots/{{ROBOT}}/revisions/{{NUMBER}}/">{{NUMBER}}</a>{{/REVISION}}{{#NO_REVISION}}none{{/NO_REVISION}} <span class="soft">{{SESSIONS}}</span> <span class="soft">{{EDGES}}</span></td></tr>
{{/ROW}}
</tbody>
</table>
</div>
{{#DRAWN}}<p class="hint">Small drawings: the worst edge of each calibration is a dot, dashed at 3 &sigma;; below, how old it was until the next one, dashed at the age that is allowed.</p>{{/DRAWN}}
{{#NOTHING}}<p class="hint">No robot is like that. <a href="./">Show all robots</a></p>{{/NOTHING}}
{{#PAGER}}<nav class="pager" aria-label="Pages">{{#BEFORE}}<a href="?q={{SEARCH}}&amp;verdict={{VERDICT}}&amp;sort={{SORT}}&amp;order={{ORDER}}&amp;page={{PAGE}}{{#CAUSE}}&amp;cause={{KEY}}{{/CAUSE}}{{#ONLY_STATUS}}&amp;status={{WORD}}{{/ONLY_STATUS}}{{#ONLY_SITE}}&amp;site={{PLACE}}{{/ONLY_SITE}}{{#ONLY_MODEL}}&amp;model={{NAME}}{{/ONLY_MODEL}}">Previous</a>{{/BEFORE}} <span>page {{PAGE}} of {{PAGES}}</span> {{#NEXT}}<a href="?q={{SEARCH}}&amp;verdict={{VERDICT}}&amp;sort={{SORT}}&amp;order={{ORDER}}&amp;page={{PAGE}}{{#CAUSE}}&amp;cause={{KEY}}{{/CAUSE}}{{#ONLY_STATUS}}&amp;status={{WORD}}{{/ONLY_STATUS}}{{#ONLY_SITE}}&amp;site={{PLACE}}{{/ONLY_SITE}}{{#ONLY_MODEL}}&amp;model={{NAME}}{{/ONLY_MODEL}}">Next</a>{{/NEXT}}</nav>{{/PAGER}}
{{#CSV}}<p class="downloads"><a class="button" href="fleet.csv?q={{SEARCH}}&amp;verdict={{VERDICT}}&amp;sort={{SORT}}&amp;order={{ORDER}}{{#CAUSE}}&amp;cause={{KEY}}{{/CAUSE}}{{#ONLY_STATUS}}&amp;status={{WORD}}{{/ONLY_STATUS}}{{#ONLY_SITE}}&amp;site={{PLACE}}{{/ONLY_SITE}}{{#ONLY_MODEL}}&amp;model={{NAME}}{{/ONLY_MODEL}}" download>This list as CSV</a> <a class="button" href="due.ics{{#CALENDAR_SITE}}?site={{PLACE}}{{/CALENDAR_SITE}}" download>Due dates as a calendar</a></p>{{/CSV}}
</section>
{{/ROBOTS}}
{{#EMPTY}}
<section class="card empty" id="live" data-live="api/v1/live">
<h2>No robot has pushed anything yet</h2>
<p>Push a capture session from the machine that has its folder:</p>
<pre><code>rigcal push path/to/session</code></pre>
<p>The robot then appears here by itself, with its sensor graph, its poses and how certain they are. If the push finds no server, this says why:</p>
<pre><code>rigcal doctor</code></pre>
</section>
{{/EMPTY}}
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
