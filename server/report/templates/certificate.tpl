{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body class="certificate">
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../../../">Fleet</a> / <a href="../../">{{ROBOT}}</a> / <a href="index.html">revision {{NUMBER}}</a> / <span>certificate</span></nav>
<header>
<h1>{{TITLE}} <span class="soft">{{ROBOT}}{{#RIG}}, rig <bdi>{{NAME}}</bdi>{{/RIG}}, revision {{NUMBER}}</span></h1>
<p class="meta">{{MEASURED}} <span dir="auto">{{STATE}}</span></p>
</header>
{{>BANNER}}
{{#PART}}
<section class="card">
<h2 id="part{{INDEX}}">{{HEADING}}</h2>
{{#TEXT}}<p class="told" dir="auto">{{LINE}}</p>{{/TEXT}}
{{#TABLE}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="part{{INDEX}}">
<table>
<thead>
<tr>{{#COLUMN}}<th scope="col">{{NAME}}</th>{{/COLUMN}}</tr>
</thead>
<tbody>
{{#ROW}}
<tr>{{#FIRST}}<th scope="row"><span class="name">{{CELL}}</span></th>{{/FIRST}}{{#CELLS}}{{#FIGURE}}<td>{{CELL}}</td>{{/FIGURE}}{{#WORDS}}<td class="text" colspan="{{SPAN}}">{{CELL}}</td>{{/WORDS}}{{/CELLS}}</tr>
{{/ROW}}
</tbody>
</table>
</div>
{{/TABLE}}
{{#NOTE}}<p class="hint" dir="auto">{{LINE}}</p>{{/NOTE}}
</section>
{{/PART}}
{{#TO_SIGN}}<section class="signature" aria-label="Signature">
<p>Place and date</p><p>Name</p><p>Signature</p>
</section>{{/TO_SIGN}}
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
